#include "devices/sim/force_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "devices/limits.hpp"

namespace voxtouch::devices {
namespace {

constexpr double kSubstep = 125e-6;

DeviceDescription device(double delay_s, double lag_s) {
  DeviceDescription d;
  d.max_force_n = 10.0;
  d.max_torque_nm = 1.0;
  d.delay_s = delay_s;
  d.force_bandwidth_hz = 1.0 / (2.0 * std::numbers::pi * lag_s);  // 0: infinity
  return d;
}

TEST(ForcePath, DelaysByExactlyTheStatedSubsteps) {
  for (int substeps : {0, 1, 7, 8, 16, 19, 256}) {
    sim::ForcePath path(device(substeps * kSubstep, 0.0), kSubstep);
    ASSERT_EQ(path.delay_substeps(), static_cast<std::size_t>(substeps));
    for (int i = 0; i < 600; ++i) {
      const Wrench out = path.step({Vec3(1.0 + i * 1e-3, 0, 0), Vec3::Zero()});
      ASSERT_EQ(out.force.x(), i < substeps ? 0.0 : 1.0 + (i - substeps) * 1e-3)
          << substeps << " " << i;
    }
  }
}

TEST(ForcePath, DelaysLikeAFirstOrderSystem) {
  const double lag = 0.003;
  sim::ForcePath path(device(0.002, lag), kSubstep);
  for (int i = 0; i < 200; ++i) {
    const Wrench out = path.step({Vec3(0, 2, 0), Vec3(0, 0, 0.5)});
    const double t = (i - 16) * kSubstep;  // at the start of the substep
    const double mean =
        i < 16 ? 0.0
               : 1.0 - std::exp(-t / lag) * lag / kSubstep * (1.0 - std::exp(-kSubstep / lag));
    ASSERT_NEAR(out.force.y(), 2.0 * mean, 2e-3) << i;
    ASSERT_NEAR(out.torque.z(), 0.5 * mean, 5e-4) << i;
  }
}

TEST(ForcePath, SaturatesInTheDirectionOfTheCommand) {
  sim::ForcePath path(device(0.0, 0.0), kSubstep);
  const Wrench out = path.step({Vec3(30, -40, 0), Vec3(0, 0, -3)});
  EXPECT_NEAR(out.force.x(), 6.0, 1e-12);
  EXPECT_NEAR(out.force.y(), -8.0, 1e-12);
  EXPECT_NEAR(out.torque.z(), -1.0, 1e-12);
  EXPECT_LE(length_of(out.force), 10.0);
}

TEST(ForcePath, ClearDropsPendingForces) {
  sim::ForcePath path(device(0.002, 0.003), kSubstep);
  for (int i = 0; i < 100; ++i)
    path.step({Vec3(1, 2, 3), Vec3(0.1, 0, 0)});
  path.clear();
  for (int i = 0; i < 300; ++i)
    ASSERT_TRUE(path.step({}).zero());
}

}  // namespace
}  // namespace voxtouch::devices
