// Parts of the driver that need no library.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "core/types/latest_value.hpp"
#include "devices/phantom/hd_errors.hpp"
#include "devices/phantom/hd_orientation.hpp"
#include "devices/phantom/phantom_options.hpp"
#include "devices/phantom/thermal_clamp.hpp"
#include "devices/phantom/twist_estimate.hpp"
#include "devices/phantom/wake_up.hpp"

namespace voxtouch::phantom {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(WakeUp, ComesForEachValueThatFoundTheOneBeforeTaken) {
  struct Pair {
    long a = 0, b = 0;
  };
  LatestValue<Pair> slot;
  WakeUp wake_up;
  constexpr long kMany = 200000;
  std::jthread writer([&] {
    for (long i = 1; i <= kMany; ++i)
      if (!slot.put({i, -i}))
        wake_up.post();
  });
  Pair seen;
  long last = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (last < kMany) {
    if (!slot.take(seen)) {
      ASSERT_TRUE(wake_up.wait_until(deadline)) << "the post of value " << last + 1 << " was lost";
      continue;
    }
    wake_up.clear();
    ASSERT_EQ(seen.a, -seen.b);
    ASSERT_GT(seen.a, last);
    last = seen.a;
  }
}

TEST(ThermalClamp, ShrinksWhileWarmAndRecoversWhenCool) {
  ThermalClamp clamp(8.5, 1.4);
  const std::vector<double> warm{0.2, 0.71, 0.2}, between{0.6, 0.2, 0.7}, cool{0.49, 0.1, 0.0};
  EXPECT_EQ(clamp.update(cool, 0.0), 8.5);
  EXPECT_DOUBLE_EQ(clamp.update(warm, 0.0), 8.5 * 0.999);
  EXPECT_DOUBLE_EQ(clamp.update(between, 8.5), 8.5 * 0.999);
  for (int i = 0; i < 5000; ++i)
    clamp.update(warm, 0.0);
  EXPECT_EQ(clamp.limit_n(), 1.4);
  EXPECT_DOUBLE_EQ(clamp.update(cool, 1.4), 1.4 * 1.001);
  for (int i = 0; i < 5000; ++i)
    clamp.update(cool, 8.5);
  EXPECT_EQ(clamp.limit_n(), 8.5);
}

TEST(ThermalClamp, StartsFromTheRequestedForce) {
  ThermalClamp clamp(8.5, 1.4);
  EXPECT_DOUBLE_EQ(clamp.update(std::array{0.8}, 4.0), 4.0 * 0.999);
  EXPECT_EQ(clamp.update(std::array{0.8}, 0.1), 1.4);  // never below the motors' continuous limit
}

TEST(ThermalClamp, TreatsNanAsWarmAndKeepsItsStateWithoutData) {
  ThermalClamp clamp(8.5, 1.4);
  EXPECT_EQ(clamp.update({}, 8.5), 8.5);
  EXPECT_LT(clamp.update(std::array{0.1, kNan}, 8.5), 8.5);
  const double before = clamp.limit_n();
  EXPECT_EQ(clamp.update({}, 1.0), before);
}

std::array<double, 16> column_major(const Mat3& rotation) {
  std::array<double, 16> m{};
  Eigen::Map<Eigen::Matrix4d> map(m.data());
  map.setIdentity();
  map.topLeftCorner<3, 3>() = rotation;
  return m;
}

TEST(HdOrientation, ReadsColumns) {
  Quat q;
  // x to y, y to -x: a rotation of 90 degrees about z has its first column (0, 1, 0).
  const std::array<double, 16> m{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
  ASSERT_TRUE(orientation_of(m.data(), q));
  EXPECT_LT((q * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
}

TEST(HdOrientation, IsTheNearestRotationAndOfUnitLength) {
  const Quat truth = Quat(0.3, -0.5, 0.7, 0.2).normalized();
  Mat3 skewed = truth.toRotationMatrix();
  // The polar decomposition removes a symmetric factor.
  Mat3 stretch = Mat3::Identity();
  stretch(0, 0) = 1.01, stretch(0, 1) = stretch(1, 0) = 0.008, stretch(2, 2) = 0.99;
  Quat q;
  ASSERT_TRUE(orientation_of(column_major(skewed * stretch).data(), q));
  EXPECT_NEAR(q.norm(), 1.0, 1e-15);
  EXPECT_LT(q.angularDistance(truth), 1e-7);
}

TEST(HdOrientation, RefusesNonRotations) {
  Quat q(0.0, 1.0, 0.0, 0.0);
  const Quat before = q;
  Mat3 m = Mat3::Identity();
  m(1, 2) = kNan;
  EXPECT_FALSE(orientation_of(column_major(m).data(), q));
  EXPECT_FALSE(orientation_of(column_major(Mat3::Zero()).data(), q));
  EXPECT_FALSE(orientation_of(column_major(Vec3(1, 1, -1).asDiagonal()).data(), q));
  EXPECT_FALSE(orientation_of(column_major(1.1 * Mat3::Identity()).data(), q));
  EXPECT_EQ(q.coeffs(), before.coeffs());
}

TEST(TwistEstimate, DelaysAccelerationByHalfAPeriodAndLowPass) {
  TwistEstimate estimate(50.0);
  constexpr double kDt = 1e-3, kAcceleration = 2.0, kTurn = 3.0;
  Twist twist;
  double t = 0.0;
  for (int i = 0; i < 500; ++i, t += kDt) {
    const Pose pose{Vec3(0, 0.5 * kAcceleration * t * t, 0),
                    Quat(Eigen::AngleAxisd(0.5 * kTurn * t * t, Vec3::UnitZ()))};
    twist = estimate.update(pose, kDt);
  }
  t -= kDt;
  const double lag = 0.5 * kDt + 1.0 / (2.0 * std::numbers::pi * 50.0);
  EXPECT_NEAR(twist.linear.y(), kAcceleration * (t - lag), 1e-6);
  EXPECT_NEAR(twist.angular.z(), kTurn * (t - lag), 1e-6);
}

TEST(TwistEstimate, IgnoresQuaternionSignAndUnequalPeriods) {
  TwistEstimate estimate(50.0);
  Twist twist;
  double t = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double dt = i % 2 == 0 ? 0.7e-3 : 1.3e-3;
    t += dt;
    Pose pose{Vec3(0.1 * t, 0, 0), Quat(Eigen::AngleAxisd(1.5 * t, Vec3::UnitX()))};
    if (i % 3 == 0)
      pose.orientation.coeffs() *= -1.0;
    twist = estimate.update(pose, dt);
  }
  EXPECT_NEAR(twist.linear.x(), 0.1, 1e-9);
  EXPECT_NEAR(twist.angular.x(), 1.5, 1e-9);
  estimate.restart();
  EXPECT_EQ(estimate.update({Vec3(9, 9, 9), Quat::Identity()}, 1e-3).linear, Vec3(Vec3::Zero()));
}

TEST(HdErrors, AreClassifiedByTheirRemedy) {
  for (const hd::HDerror code :
       {hd::kWarmMotors, hd::kExceededMaxForce, hd::kExceededMaxForceImpulse,
        hd::kExceededMaxVelocity, hd::kForceError}) {
    EXPECT_EQ(classify(code).severity, HdSeverity::kForceDropped) << code;
    EXPECT_EQ(classify(code).error, devices::DeviceError::kRecoverable) << code;
  }
  for (const hd::HDerror code : {hd::kDeviceFault, hd::kTimerError, hd::kInvalidPriority,
                                 hd::kSchedulerFull, hd::kInvalidLicense, hd::HDerror{0x0999}}) {
    EXPECT_EQ(classify(code).severity, HdSeverity::kFatal) << code;
    EXPECT_EQ(classify(code).error, devices::DeviceError::kFault) << code;
  }
  for (const hd::HDerror code : {hd::kCommError, hd::kCommConfigError, hd::kBadHandle}) {
    EXPECT_EQ(classify(code).severity, HdSeverity::kFatal) << code;
    EXPECT_EQ(classify(code).error, devices::DeviceError::kDisconnected) << code;
  }
  EXPECT_EQ(classify(hd::kFrameError).error, devices::DeviceError::kProtocol);
  EXPECT_EQ(classify(hd::kSuccess).severity, HdSeverity::kNone);
}

TEST(HdErrorLog, KeepsTheFirstFatalErrorAndCountsTheOthers) {
  HdErrorLog errors;
  errors.note(hd::kSuccess);
  EXPECT_EQ(errors.count(), 0u);
  errors.note(hd::kWarmMotors);
  errors.note(hd::kFrameError);
  errors.note(hd::kTimerError);
  errors.note(hd::kCommError);
  EXPECT_EQ(errors.count(), 2u);
  EXPECT_EQ(errors.dropped(), 1u);
  EXPECT_EQ(errors.newest(), hd::kFrameError);
  EXPECT_EQ(errors.fatal(), hd::kTimerError);
}

TEST(HdErrorLog, EndlessErrorsDoNotBlockTheServoThread) {
  static int asked = 0;
  hd::Api api;
  api.hdGetError = []() -> hd::HDErrorInfo {
    ++asked;
    return {hd::kWarmMotors, 0, 0};
  };
  HdErrorLog errors;
  errors.drain(api);
  EXPECT_LE(asked, 256);
}

}  // namespace
}  // namespace voxtouch::phantom
