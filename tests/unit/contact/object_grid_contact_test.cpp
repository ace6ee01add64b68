// Faces at whole voxels, as CAD makes them, on an object's default grid: rounding must not affect
// the result.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/voxmap/object_grid.hpp"
#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace {

constexpr double kEdge = 2e-3, kRadius = 5 * kEdge, kDepth = 0.5 * kEdge;
constexpr contact::ContactModelKind kKinds[] = {contact::ContactModelKind::kOriginal,
                                                contact::ContactModelKind::kAdapted,
                                                contact::ContactModelKind::kField};

const Ball& ball() {
  static const Ball one(kRadius, 4);
  return one;
}
const pointshell::Pointshell& shell() {
  static const pointshell::Pointshell one = exact_shell(ball().mesh, kEdge);
  return one;
}

Ground ground(const mesh::TriangleMesh& mesh) {
  return {mesh, voxmap::object_grid(mesh, kEdge), 12.0};
}

/// Depth below the surface of a box about `middle`, negative outside.
double depth_in(const Vec3& size, const Vec3& middle, const Vec3& x) {
  const Vec3 beyond = (x - middle).cwiseAbs() - 0.5 * size;
  return -(beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0));
}

TEST(FacesAtWholeVoxels, AdaptedDetectsEveryTouchOfThePlane) {
  const Vec3 size(0.24, 0.24, 0.02), middle(0, 0, -0.01);
  mesh::TriangleMesh slab = box_mesh(size, {middle, Quat::Identity()});
  for (Vec3& v : slab.vertices)
    v = v.cast<float>()
            .cast<double>();  // as every mesh file is read: the bottom lies 0.4 nm inward
  const Ground plane = ground(slab);
  contact::ContactRenderer adapted = plane.renderer(shell(), contact::ContactModelKind::kAdapted);
  std::mt19937_64 random(1);
  int missed = 0;
  constexpr int kTouches = 200;
  for (int n = 0; n < kTouches; ++n) {
    const double up = n % 2 == 0 ? 1.0 : -1.0;  // top and bottom
    const Vec3 at(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1),
                  middle.z() + up * (0.5 * size.z() + kRadius - kDepth));
    missed += adapted.probe(ball().posed(at, random_rotation(random))).wrench.force.isZero(0.0);
  }
  EXPECT_EQ(missed, 0) << "of " << kTouches;
}

TEST(FacesAtWholeVoxels, FieldDetectsAWallOfOneVoxel) {
  const Vec3 size(0.08, 0.08, kEdge), middle(0, 0, 0.5 * kEdge);
  const Ground wall = ground(box_mesh(size, {middle, Quat::Identity()}));
  contact::ContactRenderer field = wall.renderer(shell());
  std::mt19937_64 random(3);
  for (const double side : {1.0, -1.0}) {
    double got = 0.0, truth = 0.0;
    for (int n = 0; n < 20; ++n) {
      const Vec3 at(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02),
                    middle.z() + side * (0.5 * kEdge + kRadius - kDepth));
      const Pose pose = ball().posed(at, random_rotation(random));
      got += side * field.probe(pose).wrench.force.z();
      truth += integral_over(ball().mesh, pose, [&](const Vec3& x) {
                 return depth_in(size, middle, x);
               }).force.norm();
    }
    std::printf("wall of one voxel, field over the law: %.2f\n", got / truth);
    EXPECT_GT(got / truth, 0.5);
  }
}

TEST(FacesAtWholeVoxels, ANanometreChangesNothing) {
  const mesh::TriangleMesh block =
      box_mesh(Vec3(0.04, 0.06, 0.02), {Vec3(0.02, 0.03, 0.01), Quat::Identity()});
  const double away[] = {-1e-9, 0.0, 1e-9};
  std::vector<Ground> grounds;
  for (const double by : away) {
    mesh::TriangleMesh moved = block;
    for (Vec3& v : moved.vertices)
      v += by * Vec3::Ones();
    grounds.push_back(ground(moved));
  }
  for (const contact::ContactModelKind kind : kKinds) {
    std::mt19937_64 random(4);
    std::vector<contact::ContactRenderer> renderers;
    for (const Ground& one : grounds)
      renderers.push_back(one.renderer(shell(), kind));
    for (int n = 0; n < 100; ++n) {
      const Vec3 normal =
          Vec3(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0.1, 1)).normalized();
      const Pose pose = ball().posed(
          Vec3(0.04, 0.06, 0.02) - 0.01 * Vec3(uniform(random, 0, 1), uniform(random, 0, 1), 0) +
              (kRadius - kDepth) * normal,
          random_rotation(random));
      const Vec3 here = renderers[1].probe(pose).wrench.force;
      for (const std::size_t other : {0, 2})
        EXPECT_LT((renderers[other].probe(pose).wrench.force - here).norm(),
                  1e-3 * here.norm() + 1e-4)
            << contact::name_of(kind);
    }
  }
}

}  // namespace
}  // namespace voxtouch::test
