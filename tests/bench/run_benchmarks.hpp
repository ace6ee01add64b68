#pragma once
#include <benchmark/benchmark.h>

namespace voxtouch::bench {

/// Runs what is registered, as the benchmark library's options on the command line say. The
/// program's exit status.
inline int run_benchmarks(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace voxtouch::bench
