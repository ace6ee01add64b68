#include "nodes/coupling/ring_messages.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace voxtouch::coupling {
namespace {

TEST(RingMessages, AToolPoseThatIsNoneDoesNotMakeTheCommandNone) {
  DeviceSpec device;
  device.tool_offset.position = Vec3(0.0, 0.0, 0.05);
  ToDevice to_device(device);
  const Wrench wrench{Vec3(1.0, 2.0, 3.0), Vec3(0.1, 0.0, 0.0)};
  const Quat turned(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  const Wrench good = to_device(wrench, turned);
  EXPECT_EQ(good.torque, wrench_to_device(device, wrench, turned).torque) << "bit for bit";
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Quat& bad : {Quat(kNan, 0, 0, 0), Quat(0, 0, 0, 0), Quat(1e200, 1e200, 0, 0), Quat(INFINITY, 0, 0, 0)}) {
    const Wrench held = to_device(wrench, bad);
    EXPECT_TRUE(held.finite());
    EXPECT_EQ(held.torque, good.torque) << "as it was turned last";
  }
}

TEST(RingMessages, ACommandsTimeLimitIsNeverBeforeItsSample) {
  msg::ContactState contact{};
  for (const std::int64_t time : {INT64_MIN, std::int64_t{0}, INT64_MAX}) {
    contact.sample_time_ns = time;
    EXPECT_GE(force_command(contact, {}, {}, 0.005).valid_until_ns, time);
  }
}

}  // namespace
}  // namespace voxtouch::coupling
