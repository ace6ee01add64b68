#include "core/reference/closed_forms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace voxtouch::reference {
namespace {

const Pose kTurned{Vec3(0.3, -0.2, 0.7), Quat(Eigen::AngleAxisd(0.8, Vec3(1, 2, -1).normalized()))};

void expect_at(const scene::Primitive& primitive, const Vec3& x, double distance,
               const Vec3& nearest) {
  const SignedPoint found = signed_distance(primitive, x);
  EXPECT_NEAR(found.distance_m, distance, 1e-14) << x.transpose();
  EXPECT_TRUE(found.nearest.isApprox(nearest, 1e-14))
      << found.nearest.transpose() << " for " << x.transpose();
}

TEST(ClosedForms, GiveABoxItsFacesEdgesAndCorners) {
  const scene::BoxPrimitive box{{}, Vec3(2, 4, 6)};
  expect_at(box, Vec3(3, 1, 1), 2, Vec3(1, 1, 1));
  expect_at(box, Vec3(4, 6, 0), 5, Vec3(1, 2, 0));
  expect_at(box, Vec3(2, 4, 5), 3, Vec3(1, 2, 3));
  expect_at(box, Vec3(-0.5, 1, 0), -0.5, Vec3(-1, 1, 0));
  expect_at(box, Vec3(0, 1.75, 0), -0.25, Vec3(0, 2, 0));
}

TEST(ClosedForms, GiveACylinderItsSideCapsAndRims) {
  const scene::CylinderPrimitive cylinder{{}, 1.0, 4.0};
  expect_at(cylinder, Vec3(3, 0, 1), 2, Vec3(1, 0, 1));
  expect_at(cylinder, Vec3(0.5, 0, -3), 1, Vec3(0.5, 0, -2));
  expect_at(cylinder, Vec3(0, 4, 6), 5, Vec3(0, 1, 2));
  expect_at(cylinder, Vec3(0, 0.75, 0), -0.25, Vec3(0, 1, 0));
  expect_at(cylinder, Vec3(0.25, 0, 1.9), -0.1, Vec3(0.25, 0, 2));
  EXPECT_NEAR(signed_distance(scene::Primitive(cylinder), Vec3::Zero()).distance_m, -1.0, 1e-15);
}

TEST(ClosedForms, GiveASphereEvenItsCentre) {
  const scene::SpherePrimitive sphere{Vec3(1, 0, 0), 2};
  expect_at(sphere, Vec3(1, 5, 0), 3, Vec3(1, 2, 0));
  EXPECT_EQ(signed_distance(scene::Primitive(sphere), Vec3(1, 0, 0)).distance_m, -2.0);
}

TEST(ClosedForms, NearestPointsLieOnTheSurfaceAtTheDistanceGiven) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-2.0, 2.0);
  for (const scene::Primitive& primitive :
       {scene::Primitive(scene::SpherePrimitive{Vec3(0.1, 0.2, 0.3), 0.8}),
        scene::Primitive(scene::BoxPrimitive{kTurned, Vec3(0.5, 1.0, 1.5)}),
        scene::Primitive(scene::CylinderPrimitive{kTurned, 0.6, 1.1})})
    for (int i = 0; i < 500; ++i) {
      const Vec3 x(unit(random), unit(random), unit(random));
      const SignedPoint found = signed_distance(primitive, x);
      EXPECT_NEAR((x - found.nearest).norm(), std::abs(found.distance_m), 1e-13);
      EXPECT_NEAR(signed_distance(primitive, found.nearest).distance_m, 0.0, 1e-13);
    }
}

TEST(ClosedForms, UnionTakesTheNearestPart) {
  const std::vector<scene::Primitive> two{scene::SpherePrimitive{Vec3(-2, 0, 0), 1},
                                          scene::SpherePrimitive{Vec3(3, 0, 0), 1}};
  EXPECT_EQ(signed_distance(two, Vec3(1, 0, 0)).distance_m, 1.0);
  EXPECT_EQ(signed_distance(two, Vec3(3.5, 0, 0)).distance_m, -0.5);
}

TEST(ClosedForms, SamplesLieOnTheSurface) {
  for (const scene::Primitive& primitive :
       {scene::Primitive(scene::SpherePrimitive{Vec3(0.1, 0.2, 0.3), 0.8}),
        scene::Primitive(scene::BoxPrimitive{kTurned, Vec3(0.5, 1.0, 1.5)}),
        scene::Primitive(scene::CylinderPrimitive{kTurned, 0.6, 1.1})}) {
    const std::vector<Vec3> samples = surface_samples(primitive, 600);
    EXPECT_GT(samples.size(), 400U);
    for (const Vec3& x : samples)
      EXPECT_NEAR(signed_distance(primitive, x).distance_m, 0.0, 1e-13);
  }
}

}  // namespace
}  // namespace voxtouch::reference
