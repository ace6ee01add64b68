#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/types/number.hpp"

namespace voxtouch::testing {

/// The seed of a random test: `standard`, or the environment variable VOXTOUCH_SEED. The test's
/// report has it (property "seed" of --gtest_output), so that a failure can be repeated. \throws
/// std::runtime_error if VOXTOUCH_SEED is not an integer.
inline std::uint64_t seed(std::uint64_t standard) {
  std::uint64_t chosen = standard;
  if (const char* text = std::getenv("VOXTOUCH_SEED")) {
    const auto expected = parse_number<std::uint64_t>(text);
    if (!expected)
      throw std::runtime_error("VOXTOUCH_SEED is '" + std::string(text) +
                               "', not a whole number from 0 to 2^64 - 1.");
    chosen = *expected;
  }
  ::testing::Test::RecordProperty("seed", std::to_string(chosen));
  return chosen;
}

/// The sentence to put behind SCOPED_TRACE: how to run this again.
inline std::string seed_trace(std::uint64_t chosen) {
  return "run again with VOXTOUCH_SEED=" + std::to_string(chosen);
}

}  // namespace voxtouch::testing
