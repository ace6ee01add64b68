/// Many static objects: the gap is that of the nearest, and few of them are evaluated.
#include <gtest/gtest.h>

#include <random>

#include "core/reference/closed_forms.hpp"
#include "core/reference/posed_mesh.hpp"
#include "core/reference/reference_scene.hpp"
#include "test_scenes.hpp"

namespace voxtouch::reference {
namespace {

using namespace test_scenes;
using test_scenes::mesh, test_scenes::scene;

constexpr double kScale = 0.1;  ///< boxes of 0.15 x 0.1 x 0.1 m

/// 300 boxes on a grid of 0.3 m, each rotated about z, and their closed form.
struct Boxes {
  std::vector<scene::MeshSpec> specs;
  std::vector<scene::Primitive> truth;
  Boxes() {
    for (int i = 0; i < 300; ++i) {
      scene::MeshSpec spec = mesh("aligned_box.obj", kScale);
      spec.pose = {0.3 * Vec3(i % 10, (i / 10) % 10, i / 100),
                   Quat(Eigen::AngleAxisd(0.1 * i, Vec3::UnitZ()))};
      truth.push_back(scene::BoxPrimitive{spec.pose, kScale * Vec3(0.75, 0.5, 0.5)});
      specs.push_back(std::move(spec));
    }
  }
  double distance_m(const Vec3& x) const {
    double least = 1e9;
    for (const scene::Primitive& one : truth)
      least = std::min(least, signed_distance(one, x).distance_m);
    return least;
  }
  scene::Scene scene_with(scene::MeshSpec tool) const {
    scene::Scene out = scene(specs.front(), std::move(tool));
    out.static_meshes = specs;
    return out;
  }
};

TEST(BroadPhase, GivesTheGapOfTheNearestOfThreeHundred) {
  const Boxes boxes;
  const double radius = 0.02;
  const ReferenceScene reference(boxes.scene_with(sphere(radius)));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-0.3, 3.0), z(-0.3, 0.9);
  for (int i = 0; i < 100; ++i) {
    const Vec3 centre(x(random), x(random), z(random));
    const GapResult gap = reference.gap(at(centre));
    EXPECT_NEAR(gap.gap_m, boxes.distance_m(centre) - radius, 1e-9);
    EXPECT_TRUE(gap.self_check);
    EXPECT_NEAR(reference.apart_m(at(centre)), boxes.distance_m(centre) - radius, 1e-9);
    EXPECT_NEAR((reference.nearest(centre) - centre).norm(), std::abs(boxes.distance_m(centre)),
                1e-9);
  }
}

TEST(BroadPhase, GivesTheDepthOfAMeshInOneOfThreeHundred) {
  const Boxes boxes;
  const ReferenceScene all(boxes.scene_with(mesh("aligned_box.obj", 0.02))),
      one(scene(boxes.specs[137], mesh("aligned_box.obj", 0.02)));
  const Vec3 centre = boxes.specs[137].pose.position;
  for (const double offset_m : {0.0, 0.03, 0.045, 0.055, 0.07, 0.09}) {
    const Pose pose = at(centre + Vec3(0, 0, offset_m));
    const GapResult gap = all.gap(pose), alone = one.gap(pose);
    EXPECT_EQ(gap.gap_m, alone.gap_m) << offset_m;
    EXPECT_EQ(gap.direction, alone.direction) << offset_m;
    EXPECT_EQ(gap.method, alone.method) << offset_m;
  }
}

TEST(BroadPhase, QueriesFewObjects) {
  const Boxes boxes;
  std::vector<PosedMesh> objects;
  // Balls do not fill their boxes: the nearest box is not always that of the nearest object.
  for (std::size_t i = 0; i < boxes.specs.size(); ++i) {
    scene::MeshSpec ball = mesh("sphere.obj", kScale);
    ball.pose = boxes.specs[i].pose;
    objects.emplace_back(i % 2 == 0 ? boxes.specs[i] : ball);
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(0.0, 2.7), z(0.0, 0.6);
  int asked = 0;
  for (int i = 0; i < 100; ++i) {
    const Vec3 point(x(random), x(random), z(random));
    double found = 1e9, least = 1e9;
    visit_nearest_first(objects, point, 0.0, [&](std::size_t which) {
      ++asked;
      return found = std::min(found, objects[which].mesh_signed_distance(point).distance_m);
    });
    for (const PosedMesh& object : objects)
      least = std::min(least, object.mesh_signed_distance(point).distance_m);
    EXPECT_EQ(found, least) << point.transpose();
  }
  EXPECT_LT(asked, 100 * 8);
}

}  // namespace
}  // namespace voxtouch::reference
