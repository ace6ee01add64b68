// Cones of normals and the rotation before which two of them face each other, against directions
// drawn at random.
#include "core/exact/normal_cone.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/seed.hpp"

namespace voxtouch::exact {
namespace {

Vec3 direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

/// A normal within `spread_rad` or so of `about`.
Vec3 near(const Vec3& about, double spread, std::mt19937_64& random) {
  return (about + spread * direction(random)).normalized();
}

double angle(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(a.dot(b), -1.0, 1.0)); }

TEST(NormalCone, HoldsAllThatWasAdded) {
  const std::uint64_t seed = testing::seed(81);
  SCOPED_TRACE(testing::seed_trace(seed));
  std::mt19937_64 random(seed);
  for (int n = 0; n < 500; ++n) {
    const Vec3 about = direction(random);
    const double spread = 0.002 * n;
    NormalCone cone;
    std::vector<Vec3> normals;
    for (int k = 0; k < 8; ++k) {
      normals.push_back(near(about, spread, random));
      normals.push_back(near(about, spread, random));
      cone.add(NormalCone(normals[normals.size() - 2], normals.back()));
    }
    for (const Vec3& normal : normals)
      ASSERT_LE(angle(normal, cone.axis()), cone.half_rad() + 1e-7) << n;
  }
}

/// Two normals that face each other within the slack are never promised to be farther apart by
/// rotation than they are.
TEST(RotationBound, IsNoMoreThanTheRotationThatIsNeeded) {
  const std::uint64_t seed = testing::seed(82);
  SCOPED_TRACE(testing::seed_trace(seed));
  constexpr double kReach = 0.02;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 3.0);
  int away = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 of_tool = direction(random), of_object = direction(random);
    const Vec3 a = near(of_tool, 0.2, random), b = near(of_tool, 0.2, random),
               c = near(of_object, 0.2, random), d = near(of_object, 0.2, random);
    const Quat turn(Eigen::AngleAxisd(uniform(random), direction(random)));
    const RotationBound bound(NormalCone(a, b), turn.toRotationMatrix(), kReach);
    const double path = bound.path_m(NormalCone(c, d));
    away += path > 0.0;
    for (const Vec3& tool : {a, b, Vec3((a + b).normalized())})
      for (const Vec3& object : {c, d, Vec3((c + d).normalized())})
        ASSERT_LE(
            path,
            kReach * std::max(0.0, angle(-(turn * tool), object) - RotationBound::kSlackRad) + 1e-9)
            << n;
  }
  EXPECT_GT(away, 10000);
}

TEST(RotationBound, OfAnyDirectionPromisesNothing) {
  const RotationBound bound(NormalCone::all(), Mat3::Identity(), 1.0);
  EXPECT_EQ(bound.path_m(NormalCone(Vec3::UnitX(), Vec3::UnitX())), 0.0);
  const RotationBound other(NormalCone(Vec3::UnitX(), Vec3::UnitX()), Mat3::Identity(), 1.0);
  EXPECT_EQ(other.path_m(NormalCone::all()), 0.0);
}

}  // namespace
}  // namespace voxtouch::exact
