// What the plan says of walls that hold a virtual tool.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/rendering/build.hpp"
#include "core/rendering/live_scene.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/hard/faults/inputs.hpp"

namespace voxtouch::faults {
namespace {

struct Outcome {
  int passed = 0, seen = 0, unseen = 0;  ///< unseen: passed, and never reported
};

/// `attempts` balls pushed at a foil, both in mm, the voxel 2 mm, and 15 mm beyond it.
Outcome foils(double radius_mm, double foil_mm, double step_mm, int attempts) {
  Inputs inputs;
  const double foil = 1e-3 * foil_mm, radius = 1e-3 * radius_mm;
  inputs.mesh("foil", {{{-0.03, -0.03, -foil}, {0.03, 0.03, 0.0}}});
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Outcome out;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const Vec3 axis = Vec3(uniform(random), uniform(random), uniform(random)).normalized();
    const Quat tilt =
        attempt == 0 ? Quat::Identity() : Quat(Eigen::AngleAxisd(uniform(random), axis));
    const auto file = inputs.scene(
        "foil", fmt::format("static: [{{mesh: foil.obj, orientation: [{}, {}, {}, {}]}}]\n"
                            "dynamic: {{mesh: {}/meshes/sphere.obj, scale: {}}}\n"
                            "contact: {{model: field}}\ncoupling: {{design: auto}}\n",
                            tilt.w(), tilt.x(), tilt.y(), tilt.z(), VOXTOUCH_DEPLOY, radius));
    const auto built = rendering::build_scene(scene::load_scene(file), serial_for());
    rendering::LiveScene live(*built);
    live.set_spring_target(300.0);
    const Vec3 aside(0.004 * uniform(random), 0.004 * uniform(random), 0.0);
    double last = 0.0;
    bool seen = false;
    int n = 0;
    for (double z = radius + 0.008; z > -0.015; z -= 1e-3 * step_mm) {
      rendering::ToolState hand;
      hand.pose.position = tilt * (aside + Vec3(0, 0, z));
      const rendering::SceneFrame frame = live.render(hand, 1e-3 * n++);
      last = (tilt.conjugate() * frame.object.position).z();
      seen |= frame.touch.passed_through;
      if (last < -radius) {
        EXPECT_TRUE(seen) << "before the whole of it is behind";
      }
    }
    out.passed += last < 0.0, out.seen += seen;
    out.unseen += last < 0.0 && !seen;
  }
  return out;
}

/// As `voxtouch plan` says: at least 1.5 voxels of wall, or a tool of 3 voxels.
TEST(ThinFoils, HoldAsThePlanPredicts) {
  for (const double step : {0.02, 0.5}) {
    for (const double radius : {0.5, 1.5})
      EXPECT_EQ(foils(radius, 3.0, step, 5).passed, 0) << radius;
    for (const double foil : {0.02, 0.5})
      EXPECT_EQ(foils(3.0, foil, step, 5).passed, 0) << foil;
  }
}

/// A ball of 1.5 mm in foils of 0.2 and 0.5 mm is beyond that: such a sample is reported.
TEST(ThinFoils, MissedFoilsAreReported) {
  int passed = 0;
  for (const double foil : {0.02, 0.2, 0.5}) {
    const Outcome out = foils(1.5, foil, 0.05, 10);
    passed += out.passed;
    EXPECT_EQ(out.unseen, 0) << foil;
  }
  EXPECT_GT(passed, 0) << "or nothing is shown";
  EXPECT_EQ(foils(1.5, 3.0, 0.05, 5).seen, 0) << "and no other run is";
}

}  // namespace
}  // namespace voxtouch::faults
