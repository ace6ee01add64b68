// A clutch that is pressed and released in contact does not displace the wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/hard/faults/inputs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::faults {
namespace {

/// The hand rests 3 mm in a plate of 2 mm, then wants to go on through it.
std::filesystem::path clutch_scene(Inputs& inputs, double press_s, double release_s) {
  inputs.mesh("plate", {{{-0.03, -0.03, -0.002}, {0.03, 0.03, 0.0}}});
  return inputs.scene(
      "clutch", "static: [{mesh: plate.obj}]\n" + ball() +
                    fmt::format("contact: {{model: field}}\ncoupling: {{design: auto}}\n"
                                "device: {{clutch_button: 1}}\nmotions:\n"
                                "  push: {{path: [[0.001, 0.003, 0.015], [0.001, 0.003, 0.007], "
                                "[0.001, 0.003, -0.025]], speed_m_per_s: 0.01, hold_s: 1.5, "
                                "press: [{{button: 1, from_s: {}, to_s: {}}}]}}\n",
                                press_s, release_s));
}

struct ClutchRun {
  std::vector<double> force_n, tool_z_m, virtual_z_m;
  std::size_t not_initialised = 0;
};

ClutchRun clutch_run(const std::filesystem::path& scene, std::size_t samples) {
  long_runs::RigOptions options;
  options.scene = scene, options.motion = "push";
  long_runs::LoopRig rig(options);
  ClutchRun out;
  for (std::size_t n = 0; n < samples; ++n) {
    out.force_n.push_back(rig.step().force.norm());
    out.tool_z_m.push_back(rig.front().frame().object.position.z());
    out.virtual_z_m.push_back(rig.front().frame().object.position.z());
    out.not_initialised += rig.front().frame().tool.not_initialised;
  }
  return out;
}

TEST(ClutchInContact, LeavesTheWallClosed) {
  for (const double held_s : {0.05, 0.3, 1.0}) {
    Inputs inputs;
    const ClutchRun r = clutch_run(clutch_scene(inputs, 3.0, 3.0 + held_s), 9000);
    EXPECT_EQ(r.not_initialised, 0U);
    EXPECT_GT(*std::ranges::min_element(r.virtual_z_m), 0.0095) << "the ball stays above the plate";
    EXPECT_GT(r.force_n.back(), 3.0) << "the hand is far behind it";
  }
}

TEST(ClutchInContact, FadesTheForceOutAndIn) {
  Inputs inputs;
  const ClutchRun r = clutch_run(clutch_scene(inputs, 3.0, 3.5), 4500);
  const double before = r.force_n[2999];
  ASSERT_GT(before, 0.3);
  double largest = 0.0;
  for (std::size_t n = 3000; n < 3900; ++n)
    largest = std::max(largest, std::abs(r.force_n[n] - r.force_n[n - 1]));
  EXPECT_LT(largest, 0.05) << "no step, also where it is released";
  EXPECT_GT(r.force_n[3020], 0.5 * before);
  EXPECT_EQ(*std::max_element(r.force_n.begin() + 3200, r.force_n.begin() + 3500), 0.0);
  EXPECT_GT(r.force_n[3800], 0.15) << "the hand, which came nearer, rests against the plate again";
}

}  // namespace
}  // namespace voxtouch::faults
