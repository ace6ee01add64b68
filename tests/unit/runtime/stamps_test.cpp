#include "nodes/runtime/stamps.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace voxtouch::runtime {
namespace {

TEST(Stamps, DifferencesAreExactAndNeverOverflow) {
  EXPECT_EQ(ns_between(5, 1'000'005), 1'000'000);
  EXPECT_EQ(ns_between(1'000'005, 5), -1'000'000);
  EXPECT_DOUBLE_EQ(seconds_between(1'700'000'000'000'000'000, 1'700'000'000'001'000'000), 1e-3);
  for (const std::int64_t a : {INT64_MIN, std::int64_t{0}, INT64_MAX})
    for (const std::int64_t b : {INT64_MIN, std::int64_t{0}, INT64_MAX})
      EXPECT_TRUE(std::isfinite(seconds_between(a, b)));
}

TEST(Stamps, ATimeLimitIsNeverBeforeItsSample) {
  EXPECT_EQ(ns_after(7, 5'000'000), 5'000'007);
  EXPECT_EQ(ns_after(INT64_MAX - 1, 5'000'000), INT64_MAX);
  EXPECT_EQ(ns_after(INT64_MIN, 5'000'000), INT64_MIN + 5'000'000);
}

}  // namespace
}  // namespace voxtouch::runtime
