#pragma once
/// A ball of 10 mm on a virtual tool, e = 2 mm, in a hand on a simulated device: the whole loop as
/// function calls (LoopRig), with the device's pose before the encoder.
#include <fstream>

#include "core/scene/scene_file.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::test {

inline constexpr double kToolRadius = 0.01, kToolVoxel = 0.002;

/// A scene over `mesh`; the hand's motion as text.
inline std::string tool_scene(const TemporaryFolder& folder, const std::string& mesh,
                              const std::string& motion, const std::string& kind = "shaping_filter",
                              double voxel_m = kToolVoxel) {
  const std::string file = (folder / "tool.yaml").string();
  std::ofstream(file) << "scene: tool\nvoxel_size: " << voxel_m << "\nstatic: [{mesh: " << mesh
                      << "}]\ndynamic: {mesh: " << VOXTOUCH_DEPLOY
                      << "/meshes/sphere.obj, scale: " << kToolRadius
                      << "}\ncontact: {model: field, rendering: virtual_tool}\n"
                      << "coupling: {design: auto, kind: " << kind << "}\nmotions: {it: {" << motion
                      << "}}\n";
  return file;
}

/// Properties removed from the device; the coupling is designed for the complete one.
struct LeftOut {
  bool encoder = false, friction = false;
};

struct ToolSample {
  Vec3 true_hand, hand;  ///< before and behind the encoder [m]
  Vec3 true_force, contact,
      commanded;  ///< rendered at the first, at the second; force given to the device [N]
};
struct ToolRun {
  double spring_n_per_m = 0.0, encoder_m = 0.0;
  std::vector<ToolSample> samples;
};

inline ToolRun run_tool(const std::string& scene, sim::SimParameters device, const LeftOut& skipped,
                        double duration_s) {
  long_runs::RigOptions ask;
  ask.scene = scene, ask.motion = "it", ask.designed_for = device.description;
  if (skipped.encoder)
    device.description.position_resolution_m = device.description.orientation_resolution_rad = 0.0;
  if (skipped.friction)
    device.description.coulomb_friction_n = device.coulomb_friction_nm = 0.0;
  ask.device = device;
  long_runs::LoopRig rig(ask);
  const std::unique_ptr<long_runs::RigFront> exact = rig.fresh_front();
  ToolRun run{rig.spring_n_per_m(), device.description.position_resolution_m, {}};
  for (const auto n = static_cast<std::size_t>(duration_s * device.description.rate_hz);
       run.samples.size() < n;) {
    devices::DeviceSample sample = rig.read();
    ToolSample at;
    at.true_hand = rig.device().plant().pose().position, at.hand = sample.pose.position;
    rig.arrive(rig.answer(sample, rig.sequence()));
    at.contact = rig.front().frame().touch.contact.wrench.force;
    sample.pose = rig.device().plant().pose();
    exact->answer(sample);
    at.true_force = exact->frame().touch.contact.wrench.force;
    at.commanded = rig.finish().force;
    run.samples.push_back(at);
  }
  return run;
}

}  // namespace voxtouch::test
