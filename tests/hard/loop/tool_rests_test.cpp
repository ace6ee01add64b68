// A hand that rests in contact, with the encoder's steps in the loop: no cycle persists beyond
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/hard/loop/tool_loop.hpp"

namespace voxtouch::test {
namespace {

/// A plate of half a voxel, askew in the grid.
std::string write_plate(const TemporaryFolder& folder) {
  const std::string file = (folder / "plate.obj").string();
  std::ofstream out(file);
  const Quat askew(Eigen::AngleAxisd(0.3, Vec3(1, 0.4, 0.2).normalized()));
  for (int k = 0; k < 8; ++k) {
    const Vec3 v =
        askew * Vec3(k & 1 ? 0.06 : -0.06, k & 2 ? 0.06 : -0.06, k & 4 ? 0.0 : -0.5 * kToolVoxel);
    out << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  }
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return file;
}

/// Over the last second, diagonals of the boxes that hold all of them.
struct Spread {
  double pose_steps = 0.0, encoder_steps = 0.0;  ///< of the hand [steps of the encoder]
  double contact = 0.0;  ///< of the contact's force, over the spring times a step
  double commanded_n = 0.0;
};

template <class F>
double spread(const ToolRun& run, F&& of) {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  for (std::size_t i = run.samples.size() - 1000; i < run.samples.size(); ++i)
    low = low.cwiseMin(of(run.samples[i])), high = high.cwiseMax(of(run.samples[i]));
  return (high - low).norm();
}

/// The largest values of a plane, the cup and a thin plate, each pressed with the hand's target 7
/// to 10 mm inside, at places that differ by fractions of a step.
Spread rests(const char* name, const sim::SimParameters& device, const char* kind, bool friction) {
  const TemporaryFolder folder;
  const std::string meshes = std::string(VOXTOUCH_DEPLOY) + "/meshes/", plate = write_plate(folder),
                    end = "]], speed_m_per_s: 0.05, hold_s: 0.3";
  Spread most;
  for (int n = 0; n < 3; ++n) {
    const std::string in = std::to_string(1e-4 * n), in_cup = std::to_string(-0.03935 + 1e-4 * n);
    for (const auto& [mesh, motion] :
         {std::pair<std::string, std::string>{
              meshes + "plane.obj", "path: [[0.003, 0.002, 0.02], [0.003, 0.002, " + in + end},
          {meshes + "cup.obj",
           "path: [[-0.07518, -0.02736, 0.025], [" + in_cup + ", -0.0143, 0.025" + end},
          {plate, "path: [[0.003, 0.002, 0.03], [0.003, 0.002, " + in + end}}) {
      const ToolRun run = run_tool(tool_scene(folder, mesh, motion, kind), device,
                                   {.encoder = false, .friction = !friction}, 6.0);
      EXPECT_GT(run.samples.back().contact.norm(), 0.5) << mesh;
      most.pose_steps =
          std::max(most.pose_steps,
                   spread(run, [](const ToolSample& s) { return s.true_hand; }) / run.encoder_m);
      most.encoder_steps =
          std::max(most.encoder_steps,
                   spread(run, [](const ToolSample& s) { return s.hand; }) / run.encoder_m);
      most.contact = std::max(most.contact, spread(run, [](const ToolSample& s) {
                                              return s.contact;
                                            }) / (run.spring_n_per_m * run.encoder_m));
      most.commanded_n =
          std::max(most.commanded_n, spread(run, [](const ToolSample& s) { return s.commanded; }));
    }
  }
  std::printf(
      "%-11s %-14s%s: hand within %.2f steps, as reported %.2f; contact's force within %.2f of "
      "spring "
      "times step, command within %.3f N\n",
      name, kind, friction ? "" : ", no dry friction", most.pose_steps, most.encoder_steps,
      most.contact, most.commanded_n);
  return most;
}

/// Within two steps, for any friction; if the device's friction holds it, nothing moves.
void expect_no_cycle_beyond_steps(const Spread& s) {
  EXPECT_LE(s.pose_steps, 2.0);
  EXPECT_LE(s.encoder_steps, 3.0) << "a diagonal of two steps";
  EXPECT_LE(s.contact, 2.0);
}

TEST(ToolRests, WithinEncoderStepsAndStillUnderFriction) {
  for (const auto& [name, device] :
       {std::pair<const char*, sim::SimParameters>{"sim-phantom", sim::sim_phantom()},
        {"sim-lwr", sim::sim_lwr()}}) {
    const Spread s = rests(name, device, "shaping_filter", true);
    expect_no_cycle_beyond_steps(s);
    EXPECT_EQ(s.commanded_n, 0.0) << name;
  }
}

/// Only the damping of hand and device stops it: one encoder step persists. The command is then the
/// damper's answer to it. It would be 2.8 N on the arm without the slow velocity estimate for a
/// step of 0.02 mm.
TEST(ToolRests, WithinEncoderStepsWithoutFriction) {
  const Spread stylus = rests("sim-phantom", sim::sim_phantom(), "shaping_filter", false);
  expect_no_cycle_beyond_steps(stylus);
  EXPECT_LE(stylus.commanded_n, 0.1);
  const Spread arm = rests("sim-lwr", sim::sim_lwr(), "shaping_filter", false);
  expect_no_cycle_beyond_steps(arm);
  EXPECT_LE(arm.commanded_n, 0.45) << "125 Ns/m on steps of 0.02 mm";
  const Spread without_damper = rests("sim-lwr", sim::sim_lwr(), "spring_damper", false);
  expect_no_cycle_beyond_steps(without_damper);
  EXPECT_LE(without_damper.commanded_n, 0.2);
}

}  // namespace
}  // namespace voxtouch::test
