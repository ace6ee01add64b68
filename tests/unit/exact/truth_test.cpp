/// The virtual tool compared with a god-object on the same meshes that has no code in common with
/// it. The long form is tests/experiments/exact_truth.
#include <gtest/gtest.h>

#include "tests/experiments/exact_truth/comparison.hpp"

namespace voxtouch::exact_truth {
namespace {

constexpr double kDepth = 1e-3;
constexpr int kBall = 3;  // subdivisions: 642 vertices

void expect_agreement(const std::string& name, int places) {
  Comparer comparer(surface(name), kBall);
  std::mt19937_64 random(11);
  int compared = 0;
  for (int tried = 0; tried < 10 * places && compared < places; ++tried) {
    const auto c = comparer.at_random(random, kDepth);
    if (!c)
      continue;
    ++compared;
    EXPECT_TRUE(c->settled) << name << ' ' << tried;
    EXPECT_LE(c->difference.direction_deg, kDirectionDeg) << name << ' ' << tried;
    EXPECT_LE(std::abs(c->difference.force_ratio), kForceRatio) << name << ' ' << tried;
  }
  EXPECT_EQ(compared, places) << name;
}

TEST(Truth, AgreesOnAPlane) { expect_agreement("plane", 10); }

TEST(Truth, AgreesOnACylinder) { expect_agreement("cylinder", 10); }

TEST(Truth, AgreesOnTheCup) { expect_agreement("cup", 10); }

/// Sensitivity of the comparison: a plane that is 0.1 mm off is detected at each place.
TEST(Truth, AnOffsetOfATenthOfAMillimetreIsSeen) {
  for (const double offset : {1e-4, -1e-4}) {
    Comparer comparer(surface("plane"), kBall, offset);
    std::mt19937_64 random(11);
    for (int n = 0; n < 4; ++n) {
      const auto c = comparer.at_random(random, kDepth);
      ASSERT_TRUE(c);
      EXPECT_FALSE(c->difference.agrees());
      EXPECT_GT(c->difference.force_ratio * offset, 0.05 * std::abs(offset));
    }
  }
}

}  // namespace
}  // namespace voxtouch::exact_truth
