#pragma once
#include <benchmark/benchmark.h>

namespace voxtouch::bench {

/// Runs the registered benchmarks with the options of the command line. Returns the exit status.
inline int run_benchmarks(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace voxtouch::bench
