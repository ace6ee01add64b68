#include "core/effects/region.hpp"

#include <gtest/gtest.h>

#include <random>

namespace voxtouch::effects {
namespace {

Region sphere() { return {SphereRegion{Vec3(1, 2, 3), 0.05}, 0.02}; }
Region box() {
  return {BoxRegion{{Vec3(1, 2, 3), Quat(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()))},
                    Vec3(0.1, 0.04, 0.06)},
          0.02};
}

TEST(Region, IsFullInsideNothingBeyondItsBlendAndHalfInBetween) {
  EXPECT_EQ(weight_at({}, Vec3(7, 8, 9)).weight, 1.0);
  EXPECT_EQ(weight_at(sphere(), Vec3(1.049, 2, 3)).weight, 1.0);
  EXPECT_NEAR(weight_at(sphere(), Vec3(1.06, 2, 3)).weight, 0.5, 1e-12);
  EXPECT_EQ(weight_at(sphere(), Vec3(1.0701, 2, 3)).weight, 0.0);
  const Pose pose = std::get<BoxRegion>(box().shape).pose;
  EXPECT_EQ(weight_at(box(), pose * Vec3(0.049, 0.019, -0.029)).weight, 1.0);
  EXPECT_NEAR(weight_at(box(), pose * Vec3(0.049, 0.03, 0)).weight, 0.5, 1e-12);
  EXPECT_EQ(weight_at(box(), pose * Vec3(0.066, 0.034, 0)).weight, 0.0) << "round at an edge";
}

TEST(Region, HasTheGradientOfItsWeightWithinItsBounds) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-0.1, 0.1);
  for (const Region& region : {sphere(), box()}) {
    double steepest = 0.0, bent = 0.0;
    for (int attempt = 0; attempt < 3000; ++attempt) {
      const Vec3 x = Vec3(1, 2, 3) + Vec3(number(random), number(random), number(random));
      const RegionWeight here = weight_at(region, x);
      constexpr double kStep = 1e-7;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = kStep * Vec3::Unit(axis);
        const RegionWeight more = weight_at(region, x + step), less = weight_at(region, x - step);
        EXPECT_NEAR((more.weight - less.weight) / (2 * kStep), here.gradient[axis], 2e-3);
        bent = std::max(bent, (more.gradient - less.gradient).norm() / (2 * kStep));
      }
      steepest = std::max(steepest, here.gradient.norm());
    }
    EXPECT_LE(steepest, slope_bound_per_m(region) * (1 + 1e-12));
    EXPECT_GT(steepest, 0.9 * slope_bound_per_m(region));
    EXPECT_LE(bent, curvature_bound_per_m2(region) * (1 + 1e-5));
  }
}

}  // namespace
}  // namespace voxtouch::effects
