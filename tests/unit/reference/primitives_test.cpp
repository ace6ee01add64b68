/// Declared primitives compared with their meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/chord_error.hpp"
#include "test_scenes.hpp"

namespace voxtouch::reference {
namespace {

using namespace test_scenes;

ChordError error_of(const scene::MeshSpec& spec) {
  const ReferenceMesh solid = read_reference_mesh(spec);
  return chord_error(solid, MeshDistance(solid), spec.primitives);
}

/// An L of two boxes, 3 x 2 x 1: its inner seam at x = 1 is no surface.
const char* const kEll = R"(v 0 0 0
v 3 0 0
v 3 1 0
v 1 1 0
v 1 2 0
v 0 2 0
v 0 0 1
v 3 0 1
v 3 1 1
v 1 1 1
v 1 2 1
v 0 2 1
f 1 4 3
f 1 3 2
f 1 6 5
f 1 5 4
f 7 8 9
f 7 9 10
f 7 10 11
f 7 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
f 6 1 7 12
)";

TEST(DeclaredPrimitives, AreExactForABox) {
  scene::MeshSpec spec = mesh("aligned_box.obj");
  spec.primitives = {box_primitive()};
  EXPECT_NEAR(error_of(spec).value_m(), 0.0, 1e-12);
}

TEST(DeclaredPrimitives, DifferFromACylinderByTheSagOfItsChords) {
  scene::MeshSpec spec = mesh("cylinder.obj");
  spec.primitives = {cylinder_primitive()};
  const double sag = 0.5 * (1 - std::cos(std::numbers::pi / 32));
  EXPECT_NEAR(error_of(spec).mesh_to_primitives_m, sag, 3e-4);  // the file is rounded to 2^-12
  EXPECT_NEAR(error_of(spec).primitives_to_mesh_m, sag, 3e-4);
}

TEST(DeclaredPrimitives, DifferFromASphereByAFifthOfAnEdgeAtMost) {
  EXPECT_GT(error_of(sphere()).value_m(), 0.001);
  EXPECT_LT(error_of(sphere()).value_m(), kEdge / 5);
}

TEST(DeclaredPrimitives, MayBeAUnionOfParts) {
  const TemporaryMesh file("voxtouch_reference_ell.obj", kEll);
  scene::MeshSpec spec = file.spec();
  spec.primitives = {scene::BoxPrimitive{{Vec3(1.5, 0.5, 0.5), Quat::Identity()}, Vec3(3, 1, 1)},
                     scene::BoxPrimitive{{Vec3(0.5, 1.0, 0.5), Quat::Identity()}, Vec3(1, 2, 1)}};
  EXPECT_NEAR(error_of(spec).value_m(), 0.0, 1e-12);
  spec.primitives.pop_back();
  EXPECT_NEAR(error_of(spec).value_m(), 1.0, 1e-12)
      << "a part without a primitive is seen from the mesh";
}

TEST(DeclaredPrimitives, WrongPrimitivesAreOffByAsMuch) {
  const double sag = error_of(sphere()).value_m();
  scene::MeshSpec large = sphere(), moved = sphere();
  std::get<scene::SpherePrimitive>(large.primitives[0]).radius_m += 0.3 * kEdge;
  std::get<scene::SpherePrimitive>(moved.primitives[0]).centre.y() += 0.3 * kEdge;
  for (const scene::MeshSpec& spec : {large, moved})
    EXPECT_NEAR(error_of(spec).value_m(), 0.3 * kEdge, sag + 0.006 * kEdge);
}

TEST(DeclaredPrimitives, ThatTheMeshDoesNotCoverAreFound) {
  const ReferenceMesh box = read_reference_mesh(mesh("aligned_box.obj"));
  std::vector<std::array<std::uint32_t, 3>> lidless;
  for (std::size_t t = 0; t < box.triangles.size(); ++t)
    if (!(box.corner(t, 0).z() > 0 && box.corner(t, 1).z() > 0 && box.corner(t, 2).z() > 0))
      lidless.push_back(box.triangles[t]);
  ASSERT_EQ(lidless.size(), 10U);
  const ReferenceMesh open = make_reference_mesh(box.vertices, lidless, "lidless");
  const ChordError error = chord_error(open, MeshDistance(open), {box_primitive()});
  EXPECT_NEAR(error.mesh_to_primitives_m, 0.0, 1e-12) << "all of the mesh lies on the box";
  EXPECT_GT(error.primitives_to_mesh_m, 0.2) << "but not all of the box is covered";
}

}  // namespace
}  // namespace voxtouch::reference
