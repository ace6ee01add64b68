// A long tool displays at the point of contact what the plan states.
#include <gtest/gtest.h>

#include <cmath>

#include "core/device_fit/fit_coupling.hpp"
#include "core/device_fit/force_preview.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "tests/hard/faults/inputs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::faults {
namespace {

/// A rod of 6 mm that hangs `length_m` below its origin, and a wall next to its end or below it.
struct Stylus {
  Inputs inputs;
  std::filesystem::path scene;
  Stylus(double length_m, bool side) {
    inputs.mesh("rod", {{{-0.003, -0.003, -length_m}, {0.003, 0.003, 0.0}}});
    const double end = -length_m;
    inputs.mesh("wall", {side ? Box{{0.01, -0.05, end - 0.05}, {0.04, 0.05, end + 0.004}}
                              : Box{{-0.05, -0.05, end - 0.05}, {0.05, 0.05, end - 0.01}}});
    scene = inputs.scene(
        "stylus",
        fmt::format("static: [{{mesh: wall.obj}}]\ndynamic: {{mesh: rod.obj}}\n"
                    "contact: {{model: field}}\n"
                    "coupling: {{design: auto}}\nmotions:\n"
                    "  press: {{path: [[0, 0.001, 0], {}], speed_m_per_s: 0.01, hold_s: 3}}\n",
                    side ? "[0.017, 0.001, 0]" : "[0, 0.001, -0.02]"));
  }
};

device_fit::ForcePreview preview_of(const std::filesystem::path& file) {
  const scene::Scene scene = scene::load_scene(file);
  const auto built = rendering::build_scene(scene, serial_for());
  const rendering::Plan& plan = built->plan();
  DeviceDescription simulated = sim::sim_phantom().description;
  simulated.simulated = true;
  const coupling::design::DeviceModel device = coupling::design::model_of(simulated);
  const device_fit::FittedCoupling fitted =
      device_fit::fit_coupling(scene, device, plan.contact_n_per_m, plan.contact_nm_per_rad);
  return device_fit::force_preview(fitted, scene, device,
                                   {plan.contact_n_per_m, plan.contact_nm_per_rad},
                                   plan.tool_reach_m)
      .value();
}

/// Commanded force over the hand's path into the wall, at rest.
double displayed(const std::filesystem::path& file, bool side) {
  long_runs::RigOptions options;
  options.scene = file, options.motion = "press";
  long_runs::LoopRig rig(options);
  double force = 0.0, displacement = 0.0;
  for (int n = 0; n < 7800; ++n) {
    const Wrench& given = rig.step();
    if (n < 7300)
      continue;
    const Vec3& hand = rig.device().plant().pose().position;
    force += given.force.norm();
    displacement += side ? hand.x() - 0.007 : -0.01 - hand.z();
  }
  return force / displacement;
}

TEST(StylusStiffness, AlongTheArmIsTheCertifiedStiffness) {
  const Stylus down(0.15, false);
  const device_fit::ForcePreview p = preview_of(down.scene);
  EXPECT_NEAR(displayed(down.scene, false), p.stiffness_n_per_m, 0.03 * p.stiffness_n_per_m);
}

TEST(StylusStiffness, AcrossTheArmMatchesTheForcePreview) {
  for (const double length : {0.1, 0.15, 0.4}) {
    const Stylus side(length, true);
    const device_fit::ForcePreview p = preview_of(side.scene);
    EXPECT_NEAR(p.reach_m, std::hypot(length, 0.003), 0.004);
    EXPECT_NEAR(p.across_n_per_m(), p.stiffness_n_per_m / 2, 1e-9) << "the lever is the reach";
    EXPECT_NEAR(displayed(side.scene, true), p.across_n_per_m(), 0.06 * p.across_n_per_m())
        << length;
  }
}

}  // namespace
}  // namespace voxtouch::faults
