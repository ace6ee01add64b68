// Each fault on command: the caller's error, and the motors' forces in the following 100 ms.
#include <cmath>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

using Errors = std::vector<phantom::hd::HDerror>;

class Faults : public SimulatedLibrary {
 protected:
  void SetUp() override {
    SimulatedLibrary::SetUp();
    open_and_start();
    for (int i = 0; i < 20; ++i)
      tick_force(kPush);
    ASSERT_NEAR(applied().x(), kPush.x(), 0.05);
    ASSERT_EQ(errors(), Errors{});
  }
  /// Force along x after each of 100 ticks of a caller without recovery.
  std::vector<double> next_100_ms() {
    std::vector<double> force;
    for (int i = 0; i < 100; ++i) {
      tick_force(kPush);
      force.push_back(applied().x());
    }
    return force;
  }
  static int nonzero(const std::vector<double>& force) {
    return static_cast<int>(
        std::count_if(force.begin(), force.end(), [](double f) { return f != 0.0; }));
  }
  const Vec3 kPush{2.0, 0.0, 0.0};
};

TEST_F(Faults, LostCommunicationEndsTheForceByWatchdog) {
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, 100), 0);
  set_motion({0.0, 0.0, 0.0, 0.05, 0.0, 0.0}, 0.3);
  const Vec3 before = read_vector(phantom::hd::kCurrentPosition);
  const std::vector<double> force = next_100_ms();
  EXPECT_LE(nonzero(force), 10);
  EXPECT_EQ(force[20], 0.0);
  EXPECT_EQ(force[99], 0.0);
  EXPECT_EQ(read_vector(phantom::hd::kCurrentPosition), before);
  const Errors seen = errors();
  ASSERT_GE(seen.size(), 100u);  // at each frame, up to the size of the stack
  for (const phantom::hd::HDerror e : seen)
    EXPECT_EQ(e, phantom::hd::kCommError);
  tick_force(kPush);
  EXPECT_EQ(errors(), Errors{});
  EXPECT_NEAR(applied().x(), 2.0, 0.05);  // it was 100 ticks only
}

TEST_F(Faults, NoOrderReachesAnAmplifierThatCommunicationIsLostTo) {
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, 100), 0);
  tick_force(kPush);
  api.hdDisable(phantom::hd::kForceOutput);
  tick();
  EXPECT_NEAR(applied().x(), 2.0, 0.1);  // its watchdog only
  for (int i = 0; i < 10; ++i)
    tick();
  EXPECT_EQ(applied().x(), 0.0);
}

TEST_F(Faults, FailedDeviceGivesNothingAtOnce) {
  ASSERT_EQ(sim.inject(HDSIM_DEVICE_FAULT, -1), 0);
  EXPECT_EQ(nonzero(next_100_ms()), 0);
  const Errors seen = errors();
  ASSERT_EQ(seen.size(), 100u);
  EXPECT_EQ(seen.front(), phantom::hd::kDeviceFault);
  ASSERT_EQ(sim.inject(HDSIM_DEVICE_FAULT, 0), 0);
  tick_force(kPush);
  EXPECT_NEAR(applied().x(), 2.0, 0.05);
}

TEST_F(Faults, DeadTimerMeansNoCallbacksAndTheWatchdogEndsTheForce) {
  ASSERT_EQ(sim.inject(HDSIM_TIMER_ERROR, 0), 0);
  EXPECT_EQ(errors(), Errors{phantom::hd::kTimerError});
  int called = 0;
  EXPECT_EQ(tick([&] { ++called; }), 1);
  EXPECT_EQ(called, 0);
  EXPECT_NEAR(applied().x(), 2.0, 0.1);  // still displayed
  EXPECT_LE(nonzero(next_100_ms()), 10);
  EXPECT_EQ(applied().x(), 0.0);
  api.hdStopScheduler();
  api.hdStartScheduler();
  tick_force(kPush);
  EXPECT_NEAR(applied().x(), 2.0, 0.2);
}

TEST_F(Faults, WarmMotorsDropTheForceUntilTheyAreCool) {
  ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 1.0), 0);
  EXPECT_EQ(nonzero(next_100_ms()), 0);
  EXPECT_EQ(errors(), Errors{phantom::hd::kWarmMotors});
  ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 0.85), 0);
  tick_force(kPush);
  EXPECT_GT(applied().x(), 1.5);
}

TEST_F(Faults, SkippedTicksHoldTheForceUntilTheWatchdog) {
  ASSERT_EQ(sim.inject(HDSIM_SKIPPED_TICKS, 50), 0);
  std::vector<double> force;
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(tick_force(kPush), 1);
    force.push_back(applied().x());
  }
  EXPECT_NEAR(force[0], 2.0, 0.1);
  EXPECT_GE(nonzero(force), 8);
  EXPECT_LE(nonzero(force), 10);
  EXPECT_EQ(tick_force(kPush), 0);
  EXPECT_NEAR(applied().x(), 2.0, 0.1);
  EXPECT_EQ(state().ticks_without_callbacks, 50u);
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Faults, LateTickIsTimeUnderTheLastForce) {
  const double before = state().time;
  ASSERT_EQ(sim.inject(HDSIM_LATE_TICK, 0.005), 0);
  tick();
  EXPECT_NEAR(state().time - before, 0.006, 1e-12);
  tick();
  EXPECT_NEAR(state().time - before, 0.007, 1e-12);
  int rate = 0;
  api.hdGetIntegerv(phantom::hd::kUpdateRate, &rate);
  EXPECT_EQ(rate, 992) << "the mean, in which this tick counts for a hundredth";
}

TEST_F(Faults, NonFinitePositionIsReadAsSuch) {
  ASSERT_EQ(sim.inject(HDSIM_NAN_POSITION, 2), 0);
  double m[16];
  for (int i = 0; i < 3; ++i) {
    Vec3 p;
    tick([&] {
      frame([&] {
        p = read_vector(phantom::hd::kCurrentPosition);
        api.hdGetDoublev(phantom::hd::kCurrentTransform, m);
      });
    });
    EXPECT_EQ(std::isnan(p.x()), i < 2);
    EXPECT_EQ(std::isnan(m[13]), i < 2);
    EXPECT_FALSE(std::isnan(m[0]));
  }
  EXPECT_EQ(errors(), Errors{});  // no error is reported
  EXPECT_TRUE(std::isfinite(state().tip[0]));
}

TEST_F(Faults, FrameLeftOpenGivesNoForceAndSpoilsTheNext) {
  tick([&] {
    api.hdBeginFrame(device);
    api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(-2.0, 0.0, 0.0).data());
  });
  EXPECT_GT(applied().x(), 1.5);  // the last one still
  tick([&] { api.hdBeginFrame(device); });
  EXPECT_EQ(errors(), Errors{phantom::hd::kIllegalBegin});
}

TEST_F(Faults, TicksWithoutFramesHoldTheForceUntilTheWatchdog) {
  std::vector<double> force;
  for (int i = 0; i < 50; ++i) {
    tick();
    force.push_back(applied().x());
  }
  EXPECT_GE(nonzero(force), 8);
  EXPECT_LE(nonzero(force), 10);
}

TEST_F(Faults, ReleasedArmIsMovedByTheMotors) {
  sim::OperatorConfig hand;
  hand.mass_kg = 0.1;
  hand.damping_ns_per_m = 4.0;
  hand.stiffness_n_per_m = 300.0;
  hand.release_time_s = state().time + 0.01;
  ASSERT_EQ(set_hand(hand), 0) << sim.last_message();
  next_100_ms();
  EXPECT_FALSE(state().held);
  EXPECT_EQ(state().hand_force[0], 0.0);
  EXPECT_GT(state().tip_velocity[0], 1.0);  // 2 N on 0.08 kg
}

class Openings : public SimulatedLibrary {};

TEST_F(Openings, FailedInitGivesNoHandleAndItsError) {
  ASSERT_EQ(sim.inject(HDSIM_FAIL_INIT, phantom::hd::kDeviceFault), 0);
  EXPECT_EQ(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);
  const phantom::hd::HDErrorInfo info = api.hdGetError();
  EXPECT_EQ(info.error_code, phantom::hd::kDeviceFault);
  EXPECT_EQ(info.device, phantom::hd::kInvalidHandle);
  EXPECT_NE(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);  // the next one works
}

TEST_F(Openings, MissingLicenceIsReportedAtInit) {
  ASSERT_EQ(sim.inject(HDSIM_FAIL_INIT, phantom::hd::kInvalidLicense), 0);
  EXPECT_EQ(api.hdInitDevice(nullptr), phantom::hd::kInvalidHandle);
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidLicense});
}

TEST_F(Openings, FailedStartIsATimerError) {
  open();
  ASSERT_EQ(sim.inject(HDSIM_FAIL_START, 0), 0);
  api.hdStartScheduler();
  EXPECT_EQ(errors(), Errors{phantom::hd::kTimerError});
  EXPECT_FALSE(state().scheduler_running);
  api.hdStartScheduler();
  EXPECT_TRUE(state().scheduler_running);
}

TEST_F(Openings, HooksReportWhyTheyFail) {
  EXPECT_EQ(sim.set_model("falcon"), -1);
  EXPECT_NE(std::string(sim.last_message()).find("omni"), std::string::npos);
  EXPECT_EQ(sim.set_number("couloumb", 1.0), -1);
  EXPECT_NE(std::string(sim.last_message()).find("coulomb_nm"), std::string::npos);
  EXPECT_EQ(sim.set_number("coulomb_nm", std::nan("")), -1);
  EXPECT_EQ(sim.set_hand("grip: tentacle"), -1);
  EXPECT_EQ(sim.set_hand(nullptr), -1);
  EXPECT_EQ(sim.set_motion(nullptr), -1);
  EXPECT_EQ(set_motion({0.0, 0.0, 0.6}), -1);  // out of reach
  EXPECT_EQ(sim.inject(99, 0.0), -1);
  EXPECT_EQ(sim.inject(HDSIM_TIMER_ERROR, 0.0), -1);
  EXPECT_EQ(sim.inject(HDSIM_COMM_ERROR, std::nan("")), -1);
  hdsim_state s;
  EXPECT_EQ(sim.read_state(&s, sizeof s - 8), -1);
  EXPECT_EQ(set_hand(*hand::grip("pen-firm")), 0);
  EXPECT_STREQ(sim.last_message(), "");
}

/// Everything that a run of a second ends in.
struct Outcome {
  std::array<double, 3> tip, velocity, temperature, read;
  bool operator==(const Outcome&) const = default;
};

class Determinism : public SimulatedLibrary {
 protected:
  Outcome run(unsigned seed) {
    shut();
    EXPECT_EQ(sim.power_cycle(), 0);
    EXPECT_EQ(set_hand(shaky_hand(0.8)), 0);
    EXPECT_EQ(set_motion({0.0, 0.0, 0.0, 0.03, -0.02, 0.01}), 0);
    EXPECT_EQ(sim.set_seed(seed), 0);
    open_and_start();
    for (int i = 0; i < 1000; ++i) {
      tick([&] {
        frame([&] {
          const Vec3 wall = -0.3 * read_vector(phantom::hd::kCurrentPosition).cwiseMin(4.0) -
                            0.002 * read_vector(phantom::hd::kCurrentVelocity);
          api.hdSetDoublev(phantom::hd::kCurrentForce, wall.data());
        });
      });
    }
    EXPECT_EQ(errors(), Errors{});
    const hdsim_state s = state();
    Outcome r{};
    std::copy_n(s.tip, 3, r.tip.begin());
    std::copy_n(s.tip_velocity, 3, r.velocity.begin());
    std::copy_n(s.temperature, 3, r.temperature.begin());
    Eigen::Map<Vec3>(r.read.data()) = read_vector(phantom::hd::kCurrentPosition);
    return r;
  }
};

TEST_F(Determinism, SameCallsInVirtualTimeAreBitIdentical) {
  const Outcome first = run(3);
  EXPECT_EQ(run(3), first);
  EXPECT_FALSE(run(4) == first);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
