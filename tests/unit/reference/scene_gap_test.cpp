/// The gap of whole scenes compared with closed forms, with its other results.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/reference/closed_forms.hpp"
#include "core/reference/reference_scene.hpp"
#include "test_scenes.hpp"

namespace voxtouch::reference {
namespace {

using namespace test_scenes;
using test_scenes::mesh, test_scenes::scene;  // before the namespaces of these names

constexpr double kExact = 1e-9;  ///< [m], permitted difference of FCL's distance from a closed form
                                 ///< in scenes of about 1 m

scene::MeshSpec declared(const char* name, const scene::Primitive& primitive) {
  scene::MeshSpec spec = mesh(name);
  spec.primitives = {primitive};
  return spec;
}

/// Largest difference between gap and closed form over random places of the sphere, near and deep.
double largest_difference(const ReferenceScene& reference, const scene::Primitive& truth) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.3, 1.3);
  double largest = 0.0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 centre(unit(random), unit(random), unit(random));
    const GapResult gap = reference.gap(at(centre));
    EXPECT_TRUE(gap.self_check) << gap.self_error_m;
    largest = std::max(
        largest, std::abs(gap.gap_m - (signed_distance(truth, centre).distance_m - kSphereRadius)));
  }
  return largest;
}

TEST(SphereGap, ToABoxIsExactWithAndWithoutAPrimitive) {
  EXPECT_LT(largest_difference(ReferenceScene(scene(mesh("aligned_box.obj"))), box_primitive()),
            kExact);
  EXPECT_LT(largest_difference(ReferenceScene(scene(declared("aligned_box.obj", box_primitive()))),
                               box_primitive()),
            kExact);
}

TEST(SphereGap, ToACylinderIsWithinTheChordError) {
  const ReferenceScene by_mesh(scene(mesh("cylinder.obj"))),
      by_form(scene(declared("cylinder.obj", cylinder_primitive())));
  EXPECT_LT(largest_difference(by_mesh, cylinder_primitive()),
            by_form.chord_error_m() - by_mesh.chord_error_m() + 1e-4);
  EXPECT_LT(largest_difference(by_form, cylinder_primitive()), kExact);
}

TEST(SphereGap, ToASphereIsWithinTheChordError) {
  scene::MeshSpec fixed = sphere(0.75);
  const ReferenceScene by_form(scene(fixed));
  fixed.primitives.clear();
  const ReferenceScene by_mesh(scene(fixed));
  const scene::SpherePrimitive truth{Vec3::Zero(), 0.75};
  EXPECT_LT(largest_difference(by_form, truth), kExact);
  EXPECT_LT(largest_difference(by_mesh, truth), by_form.chord_error_m());
}

TEST(SphereGap, ToAPlaneIsHeightLessRadiusWithThePlanesNormal) {
  const ReferenceScene reference(scene(mesh("slab_tilted.obj")));
  const Vec3 a(-0.9384765625, -1.0849609375, -0.0673828125),
      b(1.035888671875, -0.932373046875, -0.3466796875);
  const Vec3 c(-0.95654296875, 0.720703125, 0.792724609375);
  const Vec3 up = (b - a).cross(c - a).normalized();
  for (double height : {0.9, 0.55, 0.5, 0.45, 0.3, 0.1}) {
    const GapResult gap = reference.gap(at(0.5 * (b + c) + height * up));
    EXPECT_NEAR(gap.gap_m, height - kSphereRadius, 1e-4)
        << "the slab's corners are rounded to 2^-12";
    EXPECT_GT(gap.direction.dot(up), 1 - 1e-6);
    EXPECT_EQ(gap.unique_face, gap.gap_m < std::sqrt(3.0) * kEdge) << height;
    EXPECT_NEAR(gap.nearest_dynamic.dot(up), gap.nearest_static.dot(up) + gap.gap_m, 1e-8);
  }
}

TEST(SphereGap, FollowsToolPoseScaleAndStaticPose) {
  scene::MeshSpec fixed = mesh("aligned_box.obj", 2.0);
  fixed.pose = {Vec3(0.2, -0.4, 1.0), Quat(Eigen::AngleAxisd(0.7, Vec3(1, -1, 2).normalized()))};
  scene::MeshSpec moving = sphere();
  moving.pose.position +=
      Vec3(0.3, 0.0, 0.0);  // the sphere's centre is 0.3 m off the tool's origin
  const ReferenceScene reference(scene(fixed, moving));
  const scene::BoxPrimitive truth{fixed.pose, Vec3(1.5, 1.0, 1.0)};
  const Quat turn(Eigen::AngleAxisd(1.1, Vec3::UnitZ()));
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1, 1, 2), Vec3(-0.5, 0.3, 1.4)}) {
    const double expected =
        signed_distance(scene::Primitive(truth), x + turn * Vec3(0.3, 0, 0)).distance_m -
        kSphereRadius;
    EXPECT_NEAR(reference.gap({x, turn}).gap_m, expected, kExact);
  }
}

TEST(SphereGap, LosesNothingAThousandKilometresFromTheOrigin) {
  scene::MeshSpec fixed = mesh("lshape.obj");
  const ReferenceScene here(scene(fixed));
  const Vec3 far(1048576, -1048576, 524288);
  fixed.pose.position = far;
  const ReferenceScene there(scene(fixed));
  for (const Vec3& x : {Vec3(0.5, 0.25, 0.75), Vec3(-0.25, 0.125, 0.5), Vec3(0.0, 0.75, 0.0)}) {
    const GapResult a = here.gap(at(x)), b = there.gap(at(far + x));
    EXPECT_NEAR(a.gap_m, b.gap_m, 1e-9);
    EXPECT_TRUE(a.direction.isApprox(b.direction, 1e-8));
    EXPECT_EQ(a.unique_face, b.unique_face);
  }
}

TEST(SphereGap, GrowsAlongItsDirection) {
  const ReferenceScene reference(scene(mesh("lshape.obj")));
  std::mt19937 random(13);
  std::uniform_real_distribution<double> unit(-0.7, 0.7);
  for (int i = 0; i < 200; ++i) {
    const Vec3 centre(unit(random), unit(random), unit(random));
    const GapResult gap = reference.gap(at(centre));
    if (gap.direction.isZero())
      continue;
    EXPECT_NEAR(gap.direction.norm(), 1.0, 1e-12);
    EXPECT_GE(reference.gap(at(centre + 1e-4 * gap.direction)).gap_m, gap.gap_m + 0.99e-4)
        << centre.transpose();
  }
}

TEST(SphereGap, ThinPlateLimitsTheDepth) {
  const TemporaryMesh file("voxtouch_reference_plate.obj", R"(v -1 -1 -0.02
v 1 -1 -0.02
v 1 1 -0.02
v -1 1 -0.02
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)");
  const ReferenceScene thin(scene(file.spec())), thick(scene(mesh("slab_tilted.obj")));
  const GapResult through = thin.gap(at(Vec3(0.1, 0.1, kSphereRadius - 0.2)));
  EXPECT_NEAR(through.gap_m, -0.2, kExact);
  EXPECT_EQ(through.inside_depth_m, 0.0) << "the sphere's lowest point has come out below";
  EXPECT_FALSE(through.depth_exact);
  const GapResult in_it = thin.gap(at(Vec3(0.1, 0.1, kSphereRadius - 0.012)));
  EXPECT_NEAR(in_it.inside_depth_m, 0.008, kExact);
  const GapResult deep = thick.gap(at(Vec3(0.0, 0.0, 0.65)));
  EXPECT_TRUE(deep.depth_exact);
  EXPECT_NEAR(deep.inside_depth_m, -deep.gap_m, 1e-9);
  EXPECT_GT(deep.cap_inside_depth_m, 0.0);
  EXPECT_LT(deep.cap_inside_depth_m, deep.inside_depth_m);
}

TEST(SphereGap, FaceIsUniqueOnlyForOneDirection) {
  const ReferenceScene box(
      scene(declared("aligned_box.obj", box_primitive()), sphere(0.25)));  // five edges
  EXPECT_TRUE(box.gap(at(Vec3(0, 0, 0.25 + 0.24))).unique_face);
  EXPECT_FALSE(box.gap(at(Vec3(0.36, 0, 0.25 + 0.24))).unique_face)
      << "half the patch hangs over an edge";
  EXPECT_FALSE(box.gap(at(Vec3(0.30, 0.22, -0.48))).unique_face);
  EXPECT_FALSE(box.gap(at(Vec3(0, 0, 0.25 + 0.4))).unique_face)
      << "far away no contact is possible";
  const ReferenceScene round(scene(declared("cylinder.obj", cylinder_primitive())));
  EXPECT_TRUE(round.gap(at(kCylinderCentre + Vec3(0.97, 0, 0))).unique_face);
}

TEST(SphereGap, InASlotIsThatOfTheNearerWallAndNotUnique) {
  scene::Scene slot = scene(mesh("aligned_box.obj"), sphere(0.25));
  slot.static_meshes.push_back(slot.static_meshes[0]);
  slot.static_meshes[0].pose.position = Vec3(0, 0, -0.48);
  slot.static_meshes[1].pose.position = Vec3(0, 0, 0.49);
  const ReferenceScene reference(slot);
  const GapResult middle = reference.gap(at(Vec3::Zero()));
  EXPECT_NEAR(middle.gap_m, 0.23 - 0.25, kExact);
  EXPECT_GT(middle.direction.z(), 0.999);
  EXPECT_FALSE(middle.unique_face);
  EXPECT_NEAR(reference.gap(at(Vec3(0, 0, 0.02))).gap_m, 0.22 - 0.25, kExact);
}

TEST(SphereGap, OfAnOpenMeshHasNoInside) {
  const TemporaryMesh file("voxtouch_reference_sheet.obj",
                           "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
  const ReferenceScene reference(scene(file.spec()));
  const GapResult gap = reference.gap(at(Vec3(0, 0, 0.45)));
  EXPECT_FALSE(gap.inside_known);
  EXPECT_NEAR(gap.gap_m, -0.05, kExact);
  EXPECT_EQ(gap.inside_depth_m, 0.0);
  EXPECT_FALSE(gap.depth_exact && -gap.gap_m > kEdge);
  EXPECT_TRUE(gap.self_check);
}

TEST(MeshGap, IsTheDistanceWhileApart) {
  const ReferenceScene reference(scene(mesh("aligned_box.obj"), mesh("aligned_box.obj")));
  const GapResult gap = reference.gap(at(Vec3(0.1, 0.8, 0.0)));
  EXPECT_NEAR(gap.gap_m, 0.3, kExact);
  EXPECT_NEAR(gap.direction.y(), 1.0, 1e-9);
  EXPECT_EQ(gap.method, GapMethod::kMeshMesh);
  EXPECT_TRUE(gap.self_check && gap.depth_exact);
}

TEST(MeshGap, IsABoundFromTheDeepestCornerOnceTheyOverlap) {
  const ReferenceScene reference(scene(mesh("aligned_box.obj"), mesh("aligned_box.obj", 0.5)));
  const GapResult gap = reference.gap(at(Vec3(0.1, 0.0, 0.25 + 0.125 - 0.07)));
  EXPECT_NEAR(gap.inside_depth_m, 0.07, kExact);
  EXPECT_NEAR(gap.gap_m, -0.07, kExact);
  EXPECT_NEAR(gap.direction.z(), 1.0, 1e-9);
  EXPECT_FALSE(gap.depth_exact || gap.unique_face);
  EXPECT_EQ(gap.method, GapMethod::kVertexDepth);
}

TEST(MeshGap, SeesOneObjectInsideTheOther) {
  const ReferenceScene small_in_big(scene(mesh("aligned_box.obj"), mesh("aligned_box.obj", 0.5)));
  const GapResult inside = small_in_big.gap(at(Vec3(0.01, 0, 0)));
  EXPECT_LT(inside.gap_m, 0.0);
  EXPECT_GT(inside.inside_depth_m, 0.12);
  const ReferenceScene big_round_small(
      scene(mesh("aligned_box.obj", 0.5), mesh("aligned_box.obj")));
  const GapResult swallowed = big_round_small.gap(at(Vec3(0.01, 0, 0)));
  EXPECT_LT(swallowed.gap_m, 0.0);
  EXPECT_EQ(swallowed.inside_depth_m, 0.0)
      << "no point of the dynamic surface is inside the static object";
}

TEST(ReferenceScene, AnswersANonFinitePoseWithNothing) {
  const ReferenceScene reference(scene(mesh("aligned_box.obj")));
  EXPECT_EQ(reference.gap(at(Vec3(NAN, 0, 0))).method, GapMethod::kNone);
}

TEST(ReferenceScene, RefusesASceneWithoutStaticMeshVoxelSizeOrFile) {
  scene::Scene none = scene(mesh("aligned_box.obj"));
  none.static_meshes.clear();
  EXPECT_THROW(ReferenceScene{none}, std::runtime_error);
  scene::Scene no_edge = scene(mesh("aligned_box.obj"));
  no_edge.voxel_size_m = 0;
  EXPECT_THROW(ReferenceScene{no_edge}, std::runtime_error);
  EXPECT_THROW(ReferenceScene{scene(mesh("no_such.obj"))}, std::runtime_error);
}

}  // namespace
}  // namespace voxtouch::reference
