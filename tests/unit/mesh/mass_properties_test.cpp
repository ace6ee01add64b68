#include "core/mesh/mass_properties.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "core/mesh/import.hpp"

namespace voxtouch::mesh {
namespace {

TriangleMesh shipped(const char* name) {
  return import_mesh(std::string(VOXTOUCH_DEPLOY) + "/meshes/" + name).mesh;
}

TEST(MassProperties, AreThoseOfABlock) {
  const MassProperties m = mass_properties(shipped("block.obj"));
  EXPECT_NEAR(m.volume_m3, 4.8e-5, 1e-11);
  EXPECT_LT(m.centre.norm(), 1e-8);
  EXPECT_NEAR(m.inertia_m2(0, 0), (0.0016 + 0.0009) / 12, 1e-10);
  EXPECT_NEAR(m.inertia_m2(2, 2), (0.0016 + 0.0016) / 12, 1e-10);
  EXPECT_NEAR(m.inertia_m2(0, 1), 0.0, 1e-12);
}

TEST(MassProperties, MatchABallAnywhereAndInsideOut) {
  TriangleMesh ball = shipped("sphere.obj");
  const MassProperties here = mass_properties(ball);
  EXPECT_NEAR(here.volume_m3 / (4.0 / 3.0 * std::numbers::pi), 1.0, 0.02);
  EXPECT_NEAR(here.inertia_m2(1, 1), 0.4, 0.01);
  for (Vec3& v : ball.vertices)
    v += Vec3(1e4, -2e4, 3e4);
  for (auto& t : ball.triangles)
    std::swap(t[0], t[1]);
  const MassProperties there = mass_properties(ball);
  EXPECT_NEAR(there.volume_m3, here.volume_m3, 1e-6);
  EXPECT_LT((there.centre - Vec3(1e4, -2e4, 3e4)).norm(), 1e-6);
  EXPECT_LT((there.inertia_m2 - here.inertia_m2).norm(), 1e-6);
}

TEST(MassProperties, RefuseOpenMeshes) {
  TriangleMesh flat;
  flat.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_THROW(mass_properties(flat), std::invalid_argument);
  EXPECT_THROW(mass_properties({}), std::invalid_argument);
}

}  // namespace
}  // namespace voxtouch::mesh
