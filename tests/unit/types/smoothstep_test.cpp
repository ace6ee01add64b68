#include "core/types/smoothstep.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace voxtouch {
namespace {

TEST(Smoothstep, GoesFromZeroToOneWithoutAStepOfItselfOrItsSlope) {
  EXPECT_EQ(smoothstep(2.0, 4.0, -1e300), 0.0);
  EXPECT_EQ(smoothstep(2.0, 4.0, 2.0), 0.0);
  EXPECT_EQ(smoothstep(2.0, 4.0, 3.0), 0.5);
  EXPECT_EQ(smoothstep(2.0, 4.0, 4.0), 1.0);
  EXPECT_EQ(smoothstep(2.0, 4.0, 1e300), 1.0);
  EXPECT_LT(smoothstep(2.0, 4.0, 2.001), 1e-6);
  EXPECT_GT(smoothstep(2.0, 4.0, 3.999), 1.0 - 1e-6);
}

TEST(Smoothstep, IsZeroForNan) {
  EXPECT_EQ(smoothstep(0.0, 1.0, std::numeric_limits<double>::quiet_NaN()), 0.0);
}

}  // namespace
}  // namespace voxtouch
