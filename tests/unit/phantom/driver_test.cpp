// Samples and commands of an open driver.
#include <algorithm>
#include <chrono>
#include <thread>

#include "devices/force_guard.hpp"
#include "fixture.hpp"

namespace voxtouch::phantom_test {
namespace {

class Driver : public DriverTest {};

Quat orientation_in(const hdsim_state& s) {
  return {s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]};
}

TEST_F(Driver, DescribesTheDeviceInMetresAndNewtons) {
  open_driver();
  const DeviceDescription& d = driver->description();
  EXPECT_EQ(d.model, "PHANTOM Premium 1.5");
  EXPECT_EQ(d.rate_hz, 1000.0);
  EXPECT_EQ(d.max_force_n, 8.5);
  EXPECT_EQ(d.max_torque_nm, 0.0);
  EXPECT_EQ(d.max_stiffness_n_per_m, 800.0);
  EXPECT_EQ(d.delay_s, 1e-3);
  EXPECT_EQ(d.input_dof, 6u);
  EXPECT_EQ(d.output_dof, 3u);
  EXPECT_TRUE(driver->simulated());
  EXPECT_NO_THROW(devices::guard_config(d).validate());
}

TEST_F(Driver, AForceLimitOfTheCallerOnlyLowersTheDevices) {
  options.max_force_n = 2.0;
  open_driver();
  EXPECT_EQ(driver->description().max_force_n, 2.0);
  driver.reset();
  options.max_force_n = 100.0;
  open_driver();
  EXPECT_EQ(driver->description().max_force_n, 8.5);
}

TEST_F(Driver, PoseIsTheStylusInMetresWithAUnitQuaternion) {
  const Quat expected = Quat(0.9, 0.2, -0.3, 0.1).normalized();
  Motion motion;
  motion.path = {Vec3(0.03, -0.02, 0.04)};
  motion.orientation = expected;
  ASSERT_EQ(set_motion(motion), 0) << sim.last_message();
  open_driver();
  const auto sample = driver->read(10ms);
  ASSERT_TRUE(sample);
  EXPECT_TRUE(sample->pose_valid);
  EXPECT_LT((sample->pose.position - Vec3(0.03, -0.02, 0.04)).norm(), 1e-4);
  EXPECT_NEAR(sample->pose.orientation.norm(), 1.0, 1e-15);
  EXPECT_LT(sample->pose.orientation.angularDistance(expected), 5e-3);
  EXPECT_LT(sample->pose.orientation.angularDistance(orientation_in(state())), 5e-3);
}

TEST_F(Driver, TimeStartsWithTheFirstSampleAndGoesInPeriods) {
  open_driver();
  for (std::int64_t i = 0; i < 5; ++i)
    EXPECT_EQ(driver->read(10ms)->time_ns, i * 1'000'000);
}

TEST_F(Driver, ButtonsAreBits) {
  open_driver();
  EXPECT_EQ(driver->read(10ms)->buttons, 0u);
  sim.set_switches(5, 1, 0);
  EXPECT_EQ(driver->read(10ms)->buttons, 5u);
}

TEST_F(Driver, TwistFollowsTheTipWithItsStatedDelay) {
  set_motion({0.0, 0.0, 0.0, 0.1, 0.0, 0.0}, 0.2);
  open_driver();
  std::vector<double> truth, seen;
  for (int i = 0; i < 900; ++i) {
    const auto sample = driver->read(10ms);
    seen.push_back(sample->twist.linear.x());
    truth.push_back(state().tip_velocity[0]);
  }
  // Which shift fits best; a sample is one period older than the state read after its tick.
  const auto misfit = [&](std::size_t shift) {
    double sum = 0.0;
    for (std::size_t i = 20; i < seen.size(); ++i)
      sum += std::pow(seen[i] - truth[i - shift], 2);
    return sum;
  };
  std::size_t best = 0;
  for (std::size_t shift = 0; shift < 20; ++shift)
    if (misfit(shift) < misfit(best))
      best = shift;
  EXPECT_NEAR(static_cast<double>(best), 1.0 + 3.7, 1.0);
  EXPECT_GT(*std::max_element(seen.begin(), seen.end()), 0.15);
}

TEST_F(Driver, ACommandActsInTheTickAfterItsSampleAndForOneTickOnly) {
  open_driver();
  api.hdDisable(phantom::hd::kForceRamping);
  ASSERT_TRUE(driver->read(10ms));
  ASSERT_TRUE(driver->write(push(2.0)));
  EXPECT_EQ(applied().norm(), 0.0);
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_NEAR(applied().x(), 2.0, 0.05);
  ASSERT_TRUE(driver->read(10ms));  // nothing was written meanwhile
  EXPECT_EQ(applied().norm(), 0.0);
  EXPECT_EQ(driver->servo().counts().applied.load(), 1u);
}

TEST_F(Driver, ForceRisesAlongTheDevicesRamp) {
  open_driver();
  cycle(push(2.0));
  for (int i = 0; i < 20; ++i)
    cycle(push(2.0));
  EXPECT_GT(applied().x(), 0.2);
  EXPECT_LT(applied().x(), 0.6);  // 20 N/s
}

TEST_F(Driver, NonFiniteCommandsNeverReachTheLibrary) {
  open_driver();
  push_until_steady({2.0, 0.0, 0.0});
  for (const double bad : {std::nan(""), double(INFINITY)}) {
    const auto written = driver->write(push(bad));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error(), devices::DeviceError::kNotFinite);
    ASSERT_TRUE(driver->read(10ms));
    EXPECT_EQ(applied().norm(), 0.0);
    cycle(push(2.0));
  }
  EXPECT_EQ(driver->write({Vec3::Zero(), Vec3(0, std::nan(""), 0)}).error(),
            devices::DeviceError::kNotFinite);
  EXPECT_EQ(state().non_finite_sets, 0u);
}

TEST_F(Driver, CommandsOverALimitAreZero) {
  open_driver();
  push_until_steady({2.0, 0.0, 0.0});
  for (const Wrench& over : {push(8.51), push(6.1, 6.1), Wrench{Vec3::Zero(), Vec3(0.01, 0, 0)}}) {
    const auto written = driver->write(over);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error(), devices::DeviceError::kLimit);
    ASSERT_TRUE(driver->read(10ms));
    EXPECT_EQ(applied().norm(), 0.0);
    cycle(push(2.0));
  }
}

TEST_F(Driver, ACommandBeforeTheFirstSampleIsRefused) {
  open_driver();
  EXPECT_EQ(driver->write(push(1.0)).error(), devices::DeviceError::kProtocol);
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(applied().norm(), 0.0);
}

TEST_F(Driver, StopDropsPendingForcesUntilTheNextWrite) {
  open_driver();
  push_until_steady({2.0, 0.0, 0.0});
  ASSERT_TRUE(driver->write(push(2.0)));
  driver->stop();
  driver->stop();
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(applied().norm(), 0.0);
  ASSERT_TRUE(driver->write(push(2.0)));
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_NEAR(applied().x(), 2.0, 0.05);
}

TEST_F(Driver, TorqueIsSentInMilliNewtonMetres) {
  ASSERT_EQ(sim.set_model("premium-6dof"), 0);
  Spy::instance().change_reading([](phantom::hd::HDenum name, double* values) {
    if (name == phantom::hd::kNominalMaxTorqueForce)
      values[0] = 188.0;
  });
  open_driver();
  EXPECT_DOUBLE_EQ(driver->description().max_torque_nm, 0.188);
  EXPECT_EQ(driver->description().output_dof, 6u);
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(driver->write({Vec3::Zero(), Vec3(0.2, 0, 0)}).error(), devices::DeviceError::kLimit);
  ASSERT_TRUE(driver->write({Vec3(1, 0, 0), Vec3(0.05, 0, 0)}));
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(Spy::instance().calls({"set 2701"}), std::vector<std::string>{"set 2701 50.000000"});
  EXPECT_EQ(driver->servo().errors().count(), 0u);
}

TEST_F(Driver, DestructionLeavesNothingOpenAndNoForce) {
  open_driver();
  push_until_steady({2.0, 0.0, 0.0});
  driver.reset();
  const hdsim_state s = state();
  EXPECT_FALSE(s.device_open);
  EXPECT_FALSE(s.scheduler_running);
  EXPECT_EQ(s.callbacks, 0u);
  EXPECT_EQ(s.errors_waiting, 0u);
}

TEST_F(Driver, DetectsALibraryInVirtualTime) {
  open_driver();
  EXPECT_TRUE(driver->simulated());
  EXPECT_TRUE(driver->read(0ms));
}

/// A spring against the hand, with tremor: every bit of the loop takes part.
class Lockstep : public Driver {
 protected:
  std::vector<double> run(unsigned seed) {
    driver.reset();
    EXPECT_EQ(sim.power_cycle(), 0);
    EXPECT_EQ(sim.set_seed(seed), 0);
    EXPECT_EQ(set_hand(hd_sim_test::shaky_hand()), 0);
    EXPECT_EQ(set_motion({0.0, 0.0, 0.0, 0.03, -0.02, 0.01}), 0);
    open_driver();
    devices::ForceGuard guard(devices::guard_config(driver->description()));
    std::vector<double> bits;
    for (int i = 0; i < 1000; ++i) {
      const auto sample = driver->read(10ms);
      EXPECT_TRUE(sample);
      const Pose& p = sample->pose;
      bits.insert(bits.end(), p.position.data(), p.position.data() + 3);
      bits.insert(bits.end(), p.orientation.coeffs().data(), p.orientation.coeffs().data() + 4);
      bits.insert(bits.end(), sample->twist.linear.data(), sample->twist.linear.data() + 3);
      bits.push_back(static_cast<double>(sample->time_ns));
      const Wrench spring{-300.0 * p.position - 1.0 * sample->twist.linear, Vec3::Zero()};
      const auto written = driver->write(
          guard.pass(devices::GuardInput{spring, sample->time_ns + 3'000'000}, sample->time_ns));
      EXPECT_TRUE(written) << i << " " << devices::name_of(written.error());
    }
    return bits;
  }
};

TEST_F(Lockstep, SameCallsAreBitIdentical) {
  const std::vector<double> first = run(3), second = run(3), other = run(4);
  EXPECT_EQ(first, second);
  EXPECT_NE(first, other);
}

class RealTime : public Driver {
 protected:
  void SetUp() override {
    Driver::SetUp();
    ASSERT_EQ(sim.use_virtual_time(0), 0);
  }
};

TEST_F(RealTime, ASecondOfTheServoThreadFeedsASecondOfTheLoop) {
  open_driver();
  EXPECT_FALSE(driver->simulated());
  int samples = 0;
  std::int64_t last = -1;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < 1s) {
    const auto sample = driver->read(500ms);
    ASSERT_TRUE(sample) << devices::name_of(sample.error());
    ASSERT_TRUE(sample->pose_valid);
    ASSERT_GT(sample->time_ns, last);
    last = sample->time_ns;
    ASSERT_TRUE(driver->write(push(1.0)));
    ++samples;
  }
  const phantom::ServoCounts& s = driver->servo().counts();
  EXPECT_GT(samples, 200);  // 1000 on an idle processor
  EXPECT_LT(samples, 1100);
  EXPECT_NEAR(1e-9 * static_cast<double>(last), 1.0, 0.3);
  EXPECT_GT(s.applied.load(), 200u);
  EXPECT_EQ(driver->servo().errors().count(), 0u);
  EXPECT_GT(state().hand_force[0], -5.0);
  EXPECT_LT(state().hand_force[0], -0.2);  // the hand feels it
  RecordProperty("samples", samples);
  RecordProperty("pushed", static_cast<int>(s.applied));
  RecordProperty("late", static_cast<int>(s.late));
  RecordProperty("superseded", static_cast<int>(s.superseded));
}

TEST_F(RealTime, OfSeveralSamplesTheNewestComesAndEachOnce) {
  open_driver();
  ASSERT_TRUE(driver->read(500ms));
  std::this_thread::sleep_for(50ms);
  const auto sample = driver->read(0ms);
  ASSERT_TRUE(sample);
  EXPECT_GT(sample->time_ns, 20'000'000);
  EXPECT_GT(driver->servo().counts().superseded.load(), 5u);
  int at_once = 0;
  while (driver->read(0us))
    ++at_once;
  EXPECT_LE(at_once, 5);
}

TEST_F(RealTime, AbsentReaderGivesNoForce) {
  open_driver();
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(driver->read(500ms));
    ASSERT_TRUE(driver->write(push(1.0)));
  }
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(applied().norm(), 0.0);
}

TEST_F(RealTime, DeadServoLoopIsReportedAndForceEnds) {
  open_driver();
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(driver->read(500ms));
    ASSERT_TRUE(driver->write(push(1.0)));
  }
  ASSERT_EQ(sim.inject(HDSIM_TIMER_ERROR, 0), 0);
  const auto start = std::chrono::steady_clock::now();
  devices::DeviceResult<devices::DeviceSample> sample;
  do
    sample = driver->read(500ms);
  while (sample);
  EXPECT_EQ(sample.error(), devices::DeviceError::kFault);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 100ms);  // not the whole of its timeout
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(applied().norm(), 0.0);
}

TEST_F(RealTime, UnpluggingIsReportedAtOnceAndCloses) {
  open_driver();
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(driver->read(500ms));
    ASSERT_TRUE(driver->write(push(1.0)));
  }
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, -1), 0);
  const auto start = std::chrono::steady_clock::now();
  devices::DeviceResult<devices::DeviceSample> sample;
  do
    sample = driver->read(500ms);
  while (sample);
  EXPECT_EQ(sample.error(), devices::DeviceError::kDisconnected);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 100ms);
  EXPECT_EQ(driver->write(push(1.0)).error(), devices::DeviceError::kDisconnected);
  driver->stop();
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(applied().norm(), 0.0);
  driver.reset();
  EXPECT_FALSE(state().device_open);
}

TEST_F(RealTime, SilentServoLoopTimesOutThenDisconnects) {
  options.silence_s = 0.2;
  open_driver();
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(driver->read(500ms));
    ASSERT_TRUE(driver->write(push(1.0)));
  }
  ASSERT_EQ(sim.inject(HDSIM_SKIPPED_TICKS, 600), 0);
  devices::DeviceResult<devices::DeviceSample> sample;
  do
    sample = driver->read(30ms);
  while (sample);
  EXPECT_EQ(sample.error(), devices::DeviceError::kTimeout);
  EXPECT_EQ(Spy::instance().calls({"disable 4000"}).size(), 1u);
  do
    sample = driver->read(30ms);
  while (!sample && sample.error() == devices::DeviceError::kTimeout);
  ASSERT_FALSE(sample);
  EXPECT_EQ(sample.error(), devices::DeviceError::kDisconnected);
  ASSERT_TRUE(driver->read(5s));  // it recovers: the error was not permanent
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(driver->write(push(1.0)));
    ASSERT_TRUE(driver->read(500ms));
  }
  EXPECT_GE(Spy::instance().calls({"enable 4000"}).size(), 2u);
  EXPECT_EQ(driver->servo().errors().count(), 0u);
}

}  // namespace
}  // namespace voxtouch::phantom_test
