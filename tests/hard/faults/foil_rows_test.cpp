// No wall is passed by a virtual tool, whatever its size and speed.
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
  int passed = 0, reported = 0;  ///< reported: as having passed a wall
};

/// `attempts` balls moved at a foil and 15 mm beyond it, both in mm, voxel 2 mm.
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
    int n = 0;
    for (double z = radius + 0.008; z > -0.015; z -= 1e-3 * step_mm) {
      rendering::ToolState hand;
      hand.pose.position = tilt * (aside + Vec3(0, 0, z));
      const rendering::SceneFrame frame = live.render(hand, 1e-3 * n++);
      last = (tilt.conjugate() * frame.object.position).z();
      out.reported += frame.touch.passed_through;
    }
    EXPECT_TRUE(
        live.render({.pose = {tilt * (aside + Vec3(0, 0, -0.015)), Quat::Identity()}, .twist = {}},
                    1e-3 * n)
            .tool.constrained);
    out.passed += last < 0.0;
  }
  return out;
}

/// Balls of 0.5 to 3 mm at 0.02 to 3 m/s.
TEST(ThinFoils, HoldToolsOfAnySizeAtAnySpeed) {
  for (const double step : {0.02, 0.5, 3.0})
    for (const double radius : {0.5, 1.5, 3.0})
      for (const double foil : {0.02, 0.2, 0.5, 3.0}) {
        const Outcome out = foils(radius, foil, step, 3);
        EXPECT_EQ(out.passed + out.reported, 0)
            << "ball of " << radius << " mm, foil of " << foil << " mm, " << step << " m/s";
      }
}

}  // namespace
}  // namespace voxtouch::faults
