/// Every declared primitive of a shipped scene matches its mesh, and a wrong one would be detected.
#include <gtest/gtest.h>

#include "tests/support/declared_primitives.hpp"
#include "tests/validator/shipped_scenes.hpp"

namespace voxtouch::test {
namespace {

std::vector<scene::MeshSpec> meshes_of(const scene::Scene& scene) {
  std::vector<scene::MeshSpec> meshes = scene.static_meshes;
  meshes.push_back(scene.dynamic_mesh);
  return meshes;
}

/// The lengths of a primitive, and its position.
std::vector<double*> lengths(scene::SpherePrimitive& p) { return {&p.radius_m}; }
std::vector<double*> lengths(scene::BoxPrimitive& p) {
  return {&p.size_m[0], &p.size_m[1], &p.size_m[2]};
}
std::vector<double*> lengths(scene::CylinderPrimitive& p) { return {&p.radius_m, &p.length_m}; }
Vec3& place(scene::SpherePrimitive& p) { return p.centre; }
Vec3& place(scene::BoxPrimitive& p) { return p.pose.position; }
Vec3& place(scene::CylinderPrimitive& p) { return p.pose.position; }

/// Errors that must be detected: a length 10 % off, or the whole displaced by one edge along an
/// axis.
std::vector<scene::Primitive> wrong(const scene::Primitive& right, double edge_m) {
  std::vector<scene::Primitive> all;
  const auto add = [&](auto change) {
    all.push_back(right);
    std::visit(change, all.back());
  };
  const std::size_t count = std::visit([](auto p) { return lengths(p).size(); }, right);
  for (std::size_t n = 0; n < count; ++n)
    for (const double factor : {0.9, 1.1})
      add([&](auto& p) { *lengths(p)[n] *= factor; });
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0})
      add([&](auto& p) { place(p)[axis] += sign * edge_m; });
  return all;
}

TEST(ShippedPrimitives, StandForTheirMeshes) {
  std::size_t checked = 0;
  for (const std::string& name : shipped_scene_names()) {
    const scene::Scene scene = shipped_scene(name);
    for (const scene::MeshSpec& mesh : meshes_of(scene)) {
      EXPECT_LE(primitives_off_m(mesh), kChordRatioOfEdge * scene.voxel_size_m)
          << name << ": " << mesh.path;
      checked += mesh.primitives.size();
    }
  }
  EXPECT_GE(checked, 9U) << "six spheres, two boxes, one cylinder";
}

TEST(ShippedPrimitives, SmallErrorsAreDetected) {
  for (const std::string& name : shipped_scene_names()) {
    const scene::Scene scene = shipped_scene(name);
    for (scene::MeshSpec mesh : meshes_of(scene)) {
      if (mesh.primitives.empty())
        continue;
      ASSERT_EQ(mesh.primitives.size(), 1U)
          << "of several parts, one that is wrong may hide behind another";
      for (const scene::Primitive& one : wrong(mesh.primitives.front(), scene.voxel_size_m)) {
        mesh.primitives = {one};
        EXPECT_GT(primitives_off_m(mesh), kChordRatioOfEdge * scene.voxel_size_m)
            << name << ": " << mesh.path;
      }
    }
  }
}

}  // namespace
}  // namespace voxtouch::test
