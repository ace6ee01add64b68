// A static load is displayed in full, whatever stiffness acts next to it.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <string>

#include "tests/hard/faults/inputs.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::faults {
namespace {

struct LoadCase {
  std::string name, contact, stiff;
};
void PrintTo(const LoadCase& load, std::ostream* out) { *out << load.name; }

class StaticLoad : public testing::TestWithParam<LoadCase> {};

/// A guide far away pulls with 1 N along x, equal at any place; stiff contacts act across it.
TEST_P(StaticLoad, IsFullyHeldNextToStiffContacts) {
  for (const sim::SimParameters& device : {sim::sim_phantom(), sim::sim_lwr()}) {
    Inputs inputs;
    inputs.mesh("floor", {{{-0.06, -0.04, -0.13}, {0.06, 0.04, -0.1}}});
    long_runs::RigOptions options;
    options.device = device, options.motion = "rest";
    options.scene = inputs.scene(
        "loads", "static: [{mesh: floor.obj}]\n" + ball() + GetParam().contact +
                     "coupling: {design: auto}\neffects:\n"
                     "  - name: load\n    guide_plane: {point: [-0.08, 0, 0], normal: [1, 0, 0], "
                     "stiffness_n_per_m: 100, limit_n: 1}\n" +
                     "  - name: stiff\n    " + GetParam().stiff +
                     "\nmotions:\n  rest: {path: [[0, 0, 0.0002], [0, 0, -0.0002]], "
                     "speed_m_per_s: 0.01, hold_s: 4}\n");
    long_runs::LoopRig rig(options);
    const auto samples = static_cast<std::size_t>(3.0 * rig.device_description().rate_hz);
    const std::size_t last = samples / 10;
    double along = 0.0, displayed = 0.0;
    for (std::size_t n = 0; n < samples; ++n) {
      const Wrench& given = rig.step();
      if (n + last >= samples)
        along += given.force.x() / static_cast<double>(last);
      const Mat3 stiffness = rig.front().frame().stiffness.topLeftCorner<3, 3>();
      displayed =
          std::max(displayed, Eigen::SelfAdjointEigenSolver<Mat3>(stiffness).eigenvalues()[2]);
    }
    EXPECT_NEAR(along, -1.0, 0.03);
    EXPECT_EQ(rig.front().counters().capped, 0U) << "nothing is scaled";
    EXPECT_LE(displayed, rig.spec().stiffness_cap_n_per_m * (1 + 1e-9));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Next, StaticLoad,
    testing::Values(LoadCase{"to_a_stiff_guide",
                             "contact: {model: adapted, stiffness_n_per_m: 30}\n",
                             "guide_plane: {point: [0, 0, 0], normal: [0, 0, 1], "
                             "stiffness_n_per_m: 8000, limit_n: 4}"},
                    LoadCase{"to_a_stiff_guide_with_a_virtual_tool", "contact: {model: field}\n",
                             "guide_plane: {point: [0, 0, 0], normal: [0, 0, 1], "
                             "stiffness_n_per_m: 8000, limit_n: 4}"},
                    LoadCase{"to_a_soft_guide", "contact: {model: field}\n",
                             "guide_plane: {point: [0, 0, 0], normal: [0, 0, 1], "
                             "stiffness_n_per_m: 100, limit_n: 4}"}),
    [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace voxtouch::faults
