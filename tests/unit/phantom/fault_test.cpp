// Each fault: the caller's error, and the motors' forces in the following 100 ms.
#include <algorithm>

#include "fixture.hpp"

namespace voxtouch::phantom_test {
namespace {

class Fault : public DriverTest {
 protected:
  void SetUp() override {
    DriverTest::SetUp();
    open_driver();
    push_until_steady(kPush);
    Spy::instance().reset();
  }

  struct After {
    std::vector<double> force;
    std::vector<devices::DeviceError> read,
        written;  ///< errors, without repetitions
    int samples = 0;
    int pushing() const {
      return static_cast<int>(
          std::count_if(force.begin(), force.end(), [](double f) { return f > 0.0; }));
    }
  };
  /// A loop without recovery that writes for 100 periods. If the driver makes no ticks, the arm's
  /// time advances.
  After next_100_ms() {
    After after;
    const auto note = [](std::vector<devices::DeviceError>& all, devices::DeviceError e) {
      if (all.empty() || all.back() != e)
        all.push_back(e);
    };
    for (int i = 0; i < 100; ++i) {
      const std::uint64_t ticks = state().ticks;
      const Cycle t = cycle({kPush, Vec3::Zero()});
      if (state().ticks == ticks)
        sim.step();
      after.force.push_back(applied().norm());
      if (t.sample)
        ++after.samples;
      if (!t.sample)
        note(after.read, t.sample.error());
      if (t.sample && !t.written)
        note(after.written, t.written.error());
      if (!t.sample)
        (void)driver->write({kPush, Vec3::Zero()});
    }
    return after;
  }
  const Vec3 kPush{2.0, 0.0, 0.0};
};
using Errors = std::vector<devices::DeviceError>;

TEST_F(Fault, LostCommunicationDisconnectsAndSetsNothing) {
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, 50), 0);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{devices::DeviceError::kDisconnected});
  EXPECT_EQ(after.samples, 0);
  EXPECT_EQ(Spy::instance().calls({"set"}), std::vector<std::string>{});
  EXPECT_LE(after.pushing(), 10);  // nothing gets through to the amplifier: its watchdog
  EXPECT_EQ(*std::max_element(after.force.begin() + 10, after.force.end()),
            0.0);  // also once the cable is back
  EXPECT_EQ(driver->write({kPush, Vec3::Zero()}).error(), devices::DeviceError::kDisconnected);
  EXPECT_NE(driver->last_error().find("0x0302"), std::string::npos) << driver->last_error();
  driver.reset();
  open_driver();
  push_until_steady(kPush);
}

TEST_F(Fault, UnpluggedForGoodItCanStillBeClosed) {
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, -1), 0);
  EXPECT_EQ(next_100_ms().read, Errors{devices::DeviceError::kDisconnected});
  driver.reset();
  EXPECT_FALSE(state().device_open);
  EXPECT_EQ(state().callbacks, 0u);
}

TEST_F(Fault, FailedDeviceIsAFaultWithZeroForce) {
  ASSERT_EQ(sim.inject(HDSIM_DEVICE_FAULT, 30), 0);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{devices::DeviceError::kFault});
  EXPECT_EQ(after.pushing(), 0);
  EXPECT_EQ(Spy::instance().calls({"set"}), std::vector<std::string>{});
}

TEST_F(Fault, DeadServoLoopIsAFaultWithZeroForce) {
  ASSERT_EQ(sim.inject(HDSIM_TIMER_ERROR, 0), 0);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{devices::DeviceError::kFault});
  EXPECT_LE(after.pushing(), 1);  // the period in which it died
  EXPECT_EQ(*std::max_element(after.force.begin() + 1, after.force.end()), 0.0);
}

TEST_F(Fault, WarmMotorsAreReportedOnceAndForceReturns) {
  ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 1.0), 0);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{});  // samples keep coming
  EXPECT_EQ(after.samples, 100);
  EXPECT_EQ(after.written, Errors{devices::DeviceError::kRecoverable});
  EXPECT_EQ(after.pushing(), 0);
  EXPECT_EQ(driver->servo().errors().dropped(), 1u);
  EXPECT_EQ(driver->servo().errors().newest(), phantom::hd::kWarmMotors);
  EXPECT_EQ(driver->servo().counts().withheld.load(), 1u);  // the pending command
  EXPECT_EQ(driver->servo().counts().invalid_poses.load(),
            0u);  // heat does not affect the position
  ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 0.4), 0);
  push_until_steady(kPush);
}

TEST_F(Fault, TooFastDropsTheForceAndIsReported) {
  driver.reset();
  options.max_speed_m_per_s = 0.1;
  set_motion({0.0, 0.0, 0.0, 0.12, 0.0, 0.0}, 0.5);
  open_driver();
  Errors reported;
  int after_force = 0;
  for (int i = 0; i < 1500; ++i) {
    const Cycle t = cycle(push(0.0, 0.5));
    ASSERT_TRUE(t.sample);
    if (!t.written)
      reported.push_back(t.written.error());
    const double speed = Eigen::Map<const Vec3>(state().tip_velocity).norm();
    if (speed > 0.15) {
      EXPECT_EQ(t.force, 0.0) << i;
    }
    if (!reported.empty() && t.force > 0.0)
      ++after_force;
  }
  ASSERT_FALSE(reported.empty());
  EXPECT_LE(
      reported.size(),
      5u);  // each time that the limit is passed, which quantised speeds may do more than once
  for (const devices::DeviceError error : reported)
    EXPECT_EQ(error, devices::DeviceError::kRecoverable);
  EXPECT_EQ(driver->servo().errors().newest(), phantom::hd::kExceededMaxVelocity);
  EXPECT_GT(after_force, 100);
}

TEST_F(Fault, TooLargeForceStepIsReportedAndForceReturns) {
  double limit = 1.0;
  api.hdSetDoublev(phantom::hd::kSoftwareForceImpulseLimit, &limit);
  const After after = next_100_ms();  // steady: no change
  EXPECT_EQ(after.written, Errors{});
  ASSERT_TRUE(driver->read(10ms));  // nothing was commanded: 2 N to 0 in a millisecond
  EXPECT_EQ(cycle(push(0.5)).written.error(), devices::DeviceError::kRecoverable);
  EXPECT_EQ(driver->servo().errors().newest(), phantom::hd::kExceededMaxForceImpulse);
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(cycle(push(0.5)).written);
  EXPECT_NEAR(applied().x(), 0.5, 0.05);
}

TEST_F(Fault, UnexpectedErrorsDropTheForceOfTheirTick) {
  for (const auto& [code, error] :
       {std::pair{phantom::hd::kForceError, devices::DeviceError::kRecoverable},
        std::pair{phantom::hd::kExceededMaxForce, devices::DeviceError::kRecoverable},
        std::pair{phantom::hd::kFrameError, devices::DeviceError::kProtocol},
        std::pair{phantom::hd::kInvalidOperation, devices::DeviceError::kProtocol}}) {
    Spy::instance().plant_error(code);
    ASSERT_TRUE(driver->read(10ms));
    EXPECT_EQ(applied().norm(), 0.0) << code;
    EXPECT_EQ(driver->write(push(2.0)).error(), error) << code;
    ASSERT_TRUE(driver->read(10ms));
    EXPECT_EQ(applied().norm(), 0.0) << code;
    ASSERT_TRUE(driver->write(push(2.0)));
    ASSERT_TRUE(driver->read(10ms));
    EXPECT_NEAR(applied().x(), 2.0, 0.1) << code;
    ASSERT_TRUE(driver->write(push(2.0)));
  }
}

TEST_F(Fault, UnknownErrorEndsIt) {
  Spy::instance().plant_error(0x0777);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{devices::DeviceError::kFault});
  EXPECT_EQ(after.pushing(), 0);
}

TEST_F(Fault, NonFinitePositionIsFlaggedWithoutForce) {
  const Pose before = driver->read(10ms)->pose;
  ASSERT_TRUE(driver->write(push(2.0)));
  ASSERT_EQ(sim.inject(HDSIM_NAN_POSITION, 3), 0);
  for (int i = 0; i < 3; ++i) {
    const Cycle t = cycle(push(2.0));
    ASSERT_TRUE(t.sample);
    EXPECT_FALSE(t.sample->pose_valid);
    EXPECT_TRUE(t.sample->pose.finite());
    EXPECT_EQ(t.sample->pose.position, before.position);
    EXPECT_EQ(t.sample->twist.linear, Vec3(Vec3::Zero()));
    EXPECT_EQ(t.force, 0.0);
    EXPECT_EQ(t.written.error(), devices::DeviceError::kProtocol);
  }
  EXPECT_NE(driver->last_error().find("pose"), std::string::npos);
  Cycle t = cycle(push(2.0));
  EXPECT_TRUE(t.sample->pose_valid);
  EXPECT_EQ(t.force, 0.0);
  ASSERT_TRUE(t.written);
  EXPECT_LT(t.sample->twist.linear.norm(), 0.01);
  EXPECT_NEAR(cycle(push(2.0)).force, 2.0, 0.1);
  EXPECT_EQ(driver->servo().counts().invalid_poses.load(), 3u);
}

TEST_F(Fault, AnyNonFiniteCoordinateIsEnough) {
  for (const double bad : {std::nan(""), double(INFINITY), -double(INFINITY), 1e5})
    for (int axis = 0; axis < 3; ++axis) {
      Spy::instance().change_reading([=](phantom::hd::HDenum name, double* values) {
        if (name == phantom::hd::kCurrentPosition)
          values[axis] = bad;
      });
      const Cycle t = cycle(push(2.0));
      ASSERT_TRUE(t.sample);
      EXPECT_FALSE(t.sample->pose_valid) << bad << " on axis " << axis;
      EXPECT_TRUE(t.sample->pose.finite());
      EXPECT_EQ(t.force, 0.0);
    }
}

TEST_F(Fault, NonRotationIsFlaggedAndASkewedOneRepaired) {
  Spy::instance().change_reading([](phantom::hd::HDenum name, double* m) {
    if (name == phantom::hd::kCurrentTransform)
      m[0] *= 1.01, m[5] *= 0.99;
  });
  Cycle t = cycle(push(2.0));
  ASSERT_TRUE(t.sample);
  EXPECT_TRUE(t.sample->pose_valid);
  EXPECT_NEAR(t.sample->pose.orientation.norm(), 1.0, 1e-15);
  Spy::instance().change_reading([](phantom::hd::HDenum name, double* m) {
    if (name == phantom::hd::kCurrentTransform)
      std::fill_n(m, 12, 0.0);
  });
  t = cycle(push(2.0));
  ASSERT_TRUE(t.sample);
  EXPECT_FALSE(t.sample->pose_valid);
  EXPECT_EQ(t.force, 0.0);
  EXPECT_EQ(t.written.error(), devices::DeviceError::kProtocol);
}

TEST_F(Fault, ForeignOpenFrameSpoilsOneTickOnly) {
  api.hdDisable(phantom::hd::kOneFrameLimit);
  api.hdBeginFrame(api.hdGetCurrentDevice());
  Cycle t = cycle(push(2.0));
  ASSERT_TRUE(t.sample);
  EXPECT_FALSE(t.sample->pose_valid);
  EXPECT_EQ(t.force, 0.0);
  EXPECT_EQ(t.written.error(), devices::DeviceError::kProtocol);
  EXPECT_EQ(driver->servo().errors().newest(), phantom::hd::kIllegalBegin);
  ASSERT_TRUE(cycle(push(2.0)).written);
  EXPECT_NEAR(cycle(push(2.0)).force, 2.0, 0.1);
}

TEST_F(Fault, LateTickIsCountedAndRestartsTheTwist) {
  const std::int64_t before = driver->read(10ms)->time_ns;
  ASSERT_EQ(sim.inject(HDSIM_LATE_TICK, 0.008), 0);
  const auto sample = driver->read(10ms);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->time_ns - before, 9'000'000);
  EXPECT_EQ(driver->servo().counts().late.load(), 1u);
  EXPECT_EQ(sample->twist.linear, Vec3(Vec3::Zero()));
  EXPECT_EQ(driver->read(10ms)->time_ns - before, 10'000'000);
  EXPECT_EQ(driver->servo().counts().late.load(), 1u);
}

TEST_F(Fault, AFewSkippedTicksAreWaitedFor) {
  ASSERT_EQ(sim.inject(HDSIM_SKIPPED_TICKS, 4), 0);
  const After after = next_100_ms();
  EXPECT_EQ(after.read, Errors{});
  EXPECT_EQ(after.written, Errors{});
  EXPECT_NEAR(after.force.back(), 2.0, 0.1);
  EXPECT_EQ(driver->servo().counts().late.load(), 1u);
}

TEST_F(Fault, LongSilenceDropsTheForceUntilTheNextCommand) {
  ASSERT_EQ(sim.inject(HDSIM_SKIPPED_TICKS, 25), 0);
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kTimeout);
  EXPECT_EQ(Spy::instance().calls({"disable"}), std::vector<std::string>{"disable 4000"});
  sim.step();
  EXPECT_EQ(applied().norm(), 0.0);
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kTimeout);
  driver->stop();  // as a loop does
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(Spy::instance().calls({"enable"}), std::vector<std::string>{});
  push_until_steady(kPush);
  EXPECT_EQ(Spy::instance().calls({"enable"}), std::vector<std::string>{"enable 4000"});
}

TEST_F(Fault, SchedulerStoppedExternallyIsAFault) {
  api.hdStopScheduler();
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kFault);
  api.hdStartScheduler();
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kFault);
  EXPECT_EQ(next_100_ms().pushing(), 0);
}

TEST_F(Fault, DeviceDisabledExternallyIsDisconnected) {
  api.hdDisableDevice(api.hdGetCurrentDevice());
  EXPECT_EQ(driver->read(10ms).error(), devices::DeviceError::kDisconnected);
  EXPECT_EQ(next_100_ms().pushing(), 0);
}

}  // namespace
}  // namespace voxtouch::phantom_test
