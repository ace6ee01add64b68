#pragma once
#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <string_view>

#include "core/contact/instructions.hpp"

namespace voxtouch::bench {

/// Selects the kernels of an older processor: --instructions=any, avx2, avx512 as the first option,
/// which is removed from the command line. The benchmarks' context has the choice.
inline void choose_instructions(int& argc, char**& argv) {
  using contact::Instructions;
  const std::map<std::string_view, Instructions> kinds = {
      {"--instructions=any", Instructions::kAny},
      {"--instructions=avx2", Instructions::kAvx2},
      {"--instructions=avx512", Instructions::kAvx512}};
  if (const auto kind = argc > 1 ? kinds.find(argv[1]) : kinds.end(); kind != kinds.end()) {
    contact::use_instructions(kind->second);
    argv[1] = argv[0], ++argv, --argc;
  }
  benchmark::AddCustomContext("instructions",
                              std::to_string(static_cast<int>(contact::instructions())));
}

}  // namespace voxtouch::bench
