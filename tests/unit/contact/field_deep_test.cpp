// `field` keeps its force deep inside, and flags where that ends.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "field_scenes.hpp"
#include "fixtures.hpp"

namespace voxtouch::test {
namespace field_deep_test {

constexpr double kEdge = 1e-3;

/// A plate about the origin, `thickness` along the z axis of `turn`.
mesh::TriangleMesh plate(double thickness, const Quat& turn) {
  return box_mesh(Vec3(0.07, 0.07, thickness), {Vec3::Zero(), turn});
}

const std::vector<Quat> kTurns = {Quat::Identity(),
                                  Quat(Eigen::AngleAxisd(0.5, Vec3(2, 1, -1).normalized()))};

TEST(FieldDepth, ForceGrowsToTenVoxelsInABodyOf25) {
  const Ball tool(15 * kEdge, 4);
  const pointshell::Pointshell shell = exact_shell(tool.mesh, kEdge);
  for (const Quat& turn : kTurns) {
    const Ground ground(plate(25 * kEdge, turn), kEdge);
    contact::ContactRenderer renderer = ground.renderer(shell);
    std::mt19937_64 random(21);
    for (int walk = 0; walk < 4; ++walk) {
      const Quat orientation = random_rotation(random);
      const Vec3 side(uniform(random, -0.005, 0.005), uniform(random, -0.005, 0.005), 0);
      double last = 0.0;
      for (double depth = 0.0; depth <= 10.0 * kEdge; depth += 0.02 * kEdge) {
        const Vec3 at = turn * (side + Vec3(0, 0, 12.5 * kEdge + 15 * kEdge - depth));
        const contact::ContactResult r = renderer.probe(tool.posed(at, orientation));
        const double push = r.wrench.force.dot(turn * Vec3::UnitZ());
        ASSERT_GE(push, last) << "at a depth of " << depth / kEdge << " voxels";
        ASSERT_LE(degrees_between(r.wrench.force, turn * Vec3::UnitZ()),
                  depth > 0.5 * kEdge ? 1.0 : 90.0);
        ASSERT_FALSE(r.saturated) << "at a depth of " << depth / kEdge << " voxels";
        ASSERT_NEAR(r.deepest_depth_m, depth, 0.06 * kEdge);
        last = push;
      }
      // k pi h^2 (R - h / 3): the depth under a plane over the ball's cap.
      const double depth = 10 * kEdge,
                   volume = kPressure * std::numbers::pi * depth * depth * (15 * kEdge - depth / 3);
      EXPECT_NEAR(last, volume, 0.02 * volume);
    }
  }
}

/// A tool that is smaller than the body and wholly inside floats up: k times its volume, whatever
/// the depth.
TEST(FieldDepth, FullyEnclosedToolIsPushedOutAndFlagged) {
  const Ball tool(4 * kEdge, 4);
  const Ground ground(plate(25 * kEdge, kTurns[1]), kEdge);
  contact::ContactRenderer renderer = ground.renderer(exact_shell(tool.mesh, kEdge));
  const double volume = kPressure * 4.0 / 3.0 * std::numbers::pi * std::pow(4 * kEdge, 3);
  double last = 0.0;
  for (double depth = 0.0; depth <= 11.0 * kEdge; depth += 0.05 * kEdge) {
    const Vec3 at = kTurns[1] * Vec3(0.001, 0.002, 12.5 * kEdge + 4 * kEdge - depth);
    const contact::ContactResult r = renderer.probe(tool.posed(at, kTurns[0]));
    const double push = r.wrench.force.dot(kTurns[1] * Vec3::UnitZ());
    ASSERT_GE(push, last - 0.01 * volume);
    last = push;
    if (depth > 10.0 * kEdge) {
      EXPECT_NEAR(push, volume, 0.03 * volume);
      EXPECT_EQ(r.surface_hits, 0U);
      EXPECT_TRUE(r.saturated);
    }
  }
}

/// Straight through plates of all thicknesses: a frame is flagged wherever the force decreases with
/// depth.
TEST(FieldDepth, SaturatedForceIsFlaggedBeforeItFalls) {
  const Ball tool(10 * kEdge, 4);
  const pointshell::Pointshell shell = exact_shell(tool.mesh, kEdge);
  for (const Quat& turn : kTurns)
    for (const double thickness : {2.0, 4.0, 5.0, 10.0, 16.3, 25.0}) {
      const Ground ground(plate(thickness * kEdge, turn), kEdge);
      contact::ContactRenderer renderer = ground.renderer(shell);
      double most = 0.0, flagged_from = HUGE_VAL, fallen_from = HUGE_VAL;
      for (double depth = 0.0; depth <= (thickness + 20) * kEdge; depth += 0.05 * kEdge) {
        const Vec3 at = turn * Vec3(0.001, 0.002, (0.5 * thickness + 10) * kEdge - depth);
        const contact::ContactResult r = renderer.probe(tool.posed(at, kTurns[0]));
        const double push = r.wrench.force.dot(turn * Vec3::UnitZ());
        if (r.saturated)
          flagged_from = std::min(flagged_from, depth / kEdge);
        if (push < 0.99 * most)
          fallen_from = std::min(fallen_from, depth / kEdge);
        most = std::max(most, push);
      }
      EXPECT_LE(flagged_from, fallen_from) << "a plate of " << thickness << " voxels";
      EXPECT_GE(flagged_from, std::min(12.0, 0.5 * thickness) - 1.2)
          << "flagged too soon: " << thickness;
    }
}

}  // namespace field_deep_test
}  // namespace voxtouch::test
