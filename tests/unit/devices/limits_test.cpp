#include "devices/limits.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace voxtouch::devices {
namespace limits_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kHuge = std::numeric_limits<double>::max();

TEST(Limits, LengthSurvivesOverflowAndUnderflow) {
  EXPECT_DOUBLE_EQ(length_of(Vec3(3e200, 4e200, 0)), 5e200);
  EXPECT_DOUBLE_EQ(length_of(Vec3(3e-200, 0, 4e-200)), 5e-200);
  EXPECT_EQ(length_of(Vec3::Zero()), 0.0);
}

TEST(Limits, ClampKeepsDirectionAndNeverRoundsOverTheLimit) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 expected(component(random), component(random), component(random));
    const double limit = 0.5 * (component(random) + 1.0) * length_of(expected);
    Vec3 v = expected;
    ASSERT_TRUE(clamp_length(v, limit));
    ASSERT_LE(length_of(v), limit);
    ASSERT_LE(v.norm(), limit);
    ASSERT_NEAR(v.norm(), limit, 1e-14 * limit);
    ASSERT_LE(v.cross(expected).norm(), 1e-14 * v.norm() * expected.norm() + 1e-300);
    ASSERT_GE(v.dot(expected), 0.0);
  }
}

TEST(Limits, ClampLeavesWhatFitsUntouched) {
  Vec3 v(3, 4, 0);
  EXPECT_FALSE(clamp_length(v, 5.0));
  EXPECT_EQ(v, Vec3(3, 4, 0));
  EXPECT_FALSE(clamp_length(v, kInf));
}

TEST(Limits, ClampMakesAnythingFinite) {
  for (Vec3 v :
       {Vec3(kHuge, kHuge, -kHuge), Vec3(kNan, 1, 1), Vec3(kInf, 0, 0), Vec3(-kInf, kInf, kNan)}) {
    EXPECT_TRUE(clamp_length(v, 2.0));
    EXPECT_TRUE(v.allFinite());
    EXPECT_LE(length_of(v), 2.0);
  }
  Vec3 v(kHuge, kHuge, -kHuge);
  clamp_length(v, 2.0);
  EXPECT_NEAR(v.norm(), 2.0, 1e-12);  // intermediate overflow must not remove the force
}

TEST(Limits, InvalidOrTinyLimitPassesNothing) {
  constexpr double kMin = std::numeric_limits<double>::denorm_min();
  for (double limit : {kNan, -1.0, -kInf, 0.0, -0.0, kMin, 1e-310}) {
    for (const Vec3& expected :
         {Vec3(1, 2, 3), Vec3(kMin, -kMin, kMin), Vec3(1e-309, 0, -1e-309)}) {
      Vec3 v = expected;
      EXPECT_EQ(clamp_length(v, limit), !(length_of(expected) <= limit)) << limit;
      EXPECT_TRUE(v.isZero(0.0) || length_of(v) <= limit) << limit;
    }
  }
}

TEST(Limits, OmittedTorqueIsNotCountedAsACut) {
  Wrench wrench{Vec3(1, 0, 0), Vec3(0, 2, 0)};
  EXPECT_FALSE(clamp_wrench(wrench, 5.0, 0.0).any());
  EXPECT_EQ(wrench.force, Vec3(1, 0, 0));
  EXPECT_TRUE(wrench.torque.isZero(0.0));
  Wrench both{Vec3(9, 0, 0), Vec3(0, 2, 0)};
  const WrenchCut cut = clamp_wrench(both, 5.0, 1.0);
  EXPECT_TRUE(cut.force && cut.torque);
  EXPECT_LE(length_of(both.force), 5.0);
  EXPECT_LE(length_of(both.torque), 1.0);
}

TEST(Limits, CheckRefusesNonFiniteOrExcessiveFields) {
  DeviceDescription device;
  device.max_force_n = 8.5;
  device.max_torque_nm = 0.5;
  EXPECT_TRUE(check_command({Vec3(0, 8.5, 0), Vec3(0.5, 0, 0)}, device));
  for (double bad : {kNan, kInf, -kInf})
    for (int axis = 0; axis < 6; ++axis) {
      Wrench command;
      (axis < 3 ? command.force : command.torque)[axis % 3] = bad;
      ASSERT_TRUE(check_command(command, device) == std::unexpected(DeviceError::kNotFinite));
    }
  EXPECT_TRUE(check_command({Vec3(6.1, 6.1, 0), Vec3::Zero()}, device) ==
              std::unexpected(DeviceError::kLimit));
  EXPECT_TRUE(check_command({Vec3::Zero(), Vec3(0.4, 0, 0.4)}, device) ==
              std::unexpected(DeviceError::kLimit));
}

TEST(Limits, EveryErrorHasItsOwnName) {
  EXPECT_EQ(name_of(DeviceError::kTimeout), "timeout");
  EXPECT_EQ(name_of(DeviceError::kFault), "fault");
  EXPECT_NE(name_of(DeviceError::kLimit), name_of(DeviceError::kNotFinite));
}

}  // namespace limits_test
}  // namespace voxtouch::devices
