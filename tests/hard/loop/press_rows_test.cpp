// A slow press into a penalty contact: the hand gets contact and spring in a row, whatever the
// contact's stiffness.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/hard/loop/named_device.hpp"
#include "tests/support/loop_rig/loop_rig.hpp"

namespace voxtouch::long_runs {
namespace {

/// A contact of secant stiffness K at the tool's depth, displayed behind the spring: K K_c / (K +
/// K_c).
TEST(PressRows, DisplayContactAndSpringInARow) {
  for (const char* device : {"sim-phantom", "sim-lwr"})
    for (const char* scene : {"floor.yaml", "dropout.yaml"})
      for (const double times : {1.0, 20.0}) {
        const double touch_m = scene[0] == 'f' ? 0.0 : 0.01;  // a block's lower face, and a ball's
        RigOptions options;
        options.scene = std::string(VOXTOUCH_STABILITY) + "/" + scene;
        options.device = named_device(device);
        options.stiffness_times = times;
        Motion motion;
        motion.path = {Vec3(0, 0, touch_m + 0.005), Vec3(0, 0, touch_m - 0.006)};
        motion.speed_m_per_s = 0.02, motion.hold_s = 0.1;
        options.path = motion;
        LoopRig rig(options);
        for (int n = 0; n < 3.0 * rig.device_description().rate_hz; ++n)
          rig.step();
        const rendering::SceneFrame& frame = rig.front().frame();
        const double force = frame.wrench.force.z(),
                     hand_m = touch_m - rig.device().plant().pose().position.z(),
                     tool_m = touch_m - frame.object.position.z();
        ASSERT_GT(tool_m, 0.0);
        const double contact = force / tool_m, spring = 1.0 / rig.series_spring().translation,
                     law = contact * spring / (contact + spring),
                     cap = rig.spec().stiffness_cap_n_per_m;
        std::printf(
            "%s, %s times %g: contact %.0f N/m, certified %.0f N/m, displayed %.0f N/m, %.2f of "
            "it\n",
            device, scene, times, contact, cap, force / hand_m, force / hand_m / cap);
        EXPECT_NEAR(force / hand_m, law, 0.03 * law);
        EXPECT_LE(force / hand_m, 1.01 * cap);
      }
}

}  // namespace
}  // namespace voxtouch::long_runs
