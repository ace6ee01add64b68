// A slide with friction: the command makes no step that the contact does not make. The largest
// steps, which are printed, are those of an encoder's step while friction sticks, and of a slide
// that begins to stick.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/hard/loop/named_device.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

constexpr double kMinForceN = 0.05;

class Slides : public testing::TestWithParam<const char*> {};

TEST_P(Slides, WithFrictionMakeNoPerceptibleStep) {
  for (const double speed : {0.005, 0.03, 0.2}) {
    RigOptions options;
    options.scene = std::string(VOXTOUCH_STABILITY) + "/slide_friction.yaml";
    options.device = named_device(GetParam());
    const double path_m = std::min(0.06, 1.5 * speed);
    Motion motion;
    motion.path = {Vec3(-0.03, 0, 0.012), Vec3(-0.03, 0, 0.006),
                   Vec3(path_m - 0.03, 0.01 * path_m / 0.06, 0.006)};
    motion.speed_m_per_s = speed, motion.hold_s = 0.2, motion.repeat_from = 1;
    options.path = motion;
    LoopRig rig(options);
    const double rate = rig.device_description().rate_hz;
    std::vector<double> steps;
    Vec3 last = Vec3::Zero(), last_contact = Vec3::Zero();
    for (int n = 0; n < 5.0 * rate; ++n) {
      const Vec3 given = rig.step().force, contact = rig.front().frame().wrench.force;
      if (!last_contact.isZero(0.0) && !contact.isZero(0.0))
        steps.push_back(std::max(
            0.0, (given - last).head<2>().norm() - (contact - last_contact).head<2>().norm()));
      last = given, last_contact = contact;
    }
    ASSERT_FALSE(steps.empty());
    std::sort(steps.begin(), steps.end());
    const double at_95 = steps[steps.size() * 95 / 100];
    std::printf("%s, %.0f mm/s: steps across of %.3f N at 95 %%, %.3f N at most\n", GetParam(),
                1e3 * speed, at_95, steps.back());
    // Not met by a Premium 3.0 at 200 mm/s.
    const double most = std::string(GetParam()) == "premium_3" && speed > 0.1 ? 0.07 : kMinForceN;
    EXPECT_LE(at_95, most) << speed;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, Slides,
                         testing::Values("sim-lwr", "sim-phantom", "delta_6", "falcon", "fr3",
                                         "iiwa_7", "inverse3", "omega_3", "omega_6", "omega_7",
                                         "premium_3", "sigma_7", "touch", "touch_x",
                                         "virtuose_6d"));

}  // namespace
}  // namespace voxtouch::long_runs
