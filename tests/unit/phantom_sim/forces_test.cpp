// Forces at the motors: switches, overrides, limits, ramps, heat, calibration.
#include <algorithm>
#include <cmath>

#include "library.hpp"

namespace voxtouch::hd_sim_test {
namespace {

using Errors = std::vector<phantom::hd::HDerror>;

class Forces : public SimulatedLibrary {
 protected:
  void set_number(phantom::hd::HDenum name, double value) { api.hdSetDoublev(name, &value); }
  double motor(int i) { return state().motor_torque[i]; }
};

TEST_F(Forces, NothingIsGivenBeforeForceOutputIsOn) {
  open_and_start();
  api.hdDisable(phantom::hd::kForceOutput);
  tick_force({2.0, 0.0, 0.0});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  api.hdEnable(phantom::hd::kForceOutput);
  EXPECT_TRUE(api.hdIsEnabled(phantom::hd::kForceOutput));
  tick_force({2.0, 0.0, 0.0});
  EXPECT_NEAR(applied().x(), 2.0, 0.02);
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Forces, SwitchingOutputOffTakesTheForceAtOnce) {
  open_and_start();
  tick_force({2.0, 0.0, 0.0});
  api.hdDisable(phantom::hd::kForceOutput);
  tick();
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Forces, FrameOutsideTheSchedulerGivesNone) {
  open();
  frame([&] { api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(2.0, 0.0, 0.0).data()); });
  api.hdStartScheduler();
  sim.step();
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Forces, StoppingTheSchedulerEndsThem) {
  open_and_start();
  tick_force({2.0, 0.0, 0.0});
  api.hdStopScheduler();
  api.hdStartScheduler();
  tick();
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Forces, MotorsGiveTheTransposedJacobianOfTheForce) {
  open_and_start();
  tick_force({1.0, 2.0, 3.0});
  EXPECT_NEAR(motor(0), 0.215 * 1.0,
              2e-3);  // in the reset pose the thigh lifts, the shin moves horizontally
  EXPECT_NEAR(motor(1), 0.215 * 2.0, 2e-3);
  EXPECT_NEAR(motor(2), 0.170 * 3.0, 2e-3);
}

TEST_F(Forces, TorqueNeedsMotorsInTheGimbal) {
  open_and_start();
  tick([&] {
    frame([&] { api.hdSetDoublev(phantom::hd::kCurrentTorque, Vec3(10.0, 0.0, 0.0).data()); });
  });
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidOperation});
  shut();
  ASSERT_EQ(sim.set_model("premium-6dof"), 0);
  open_and_start();
  Vec3 seen;
  tick([&] {
    frame([&] {
      api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(1.0, 0.0, 0.0).data());
      api.hdSetDoublev(phantom::hd::kCurrentTorque, Vec3(10.0, 0.0, 0.0).data());
      seen = read_vector(phantom::hd::kCurrentTorque);
    });
  });
  EXPECT_EQ(errors(), Errors{});
  EXPECT_DOUBLE_EQ(seen.x(), 10.0);
  EXPECT_NEAR(applied().x(), 1.0, 0.02);
}

TEST_F(Forces, ClampingCutsSilentlyAndKeepsTheDirection) {
  open_and_start();
  api.hdEnable(phantom::hd::kMaxForceClamping);
  set_number(phantom::hd::kSoftwareForceImpulseLimit, 1000.0);
  tick_force({30.0, 40.0, 0.0});
  EXPECT_EQ(errors(), Errors{});
  EXPECT_NEAR(motor(0) / motor(1), 0.75, 0.01);
  EXPECT_NEAR(std::hypot(motor(0), motor(1)), 8.5 * 0.215, 1e-2);
}

TEST_F(Forces, MoreThanTheMaximumIsAnErrorAndNoForce) {
  open_and_start();
  set_number(phantom::hd::kSoftwareForceImpulseLimit, 1000.0);
  tick_force({8.6, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{phantom::hd::kExceededMaxForce});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  tick_force({8.4, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{});
  EXPECT_NEAR(applied().x(), 8.4, 0.1);
  api.hdDisable(phantom::hd::kSoftwareForceLimit);
  tick_force({20.0, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{});
  EXPECT_NEAR(motor(0), 1.8275, 1e-9);  // the motor's limit
}

TEST_F(Forces, ImpulseOverItsLimitIsAnErrorAndNoForce) {
  open_and_start();
  set_number(phantom::hd::kSoftwareForceImpulseLimit, 2.0);
  tick_force({3.0, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{phantom::hd::kExceededMaxForceImpulse});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  for (double f : {1.5, 3.0, 4.5})
    tick_force({f, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{});
  EXPECT_NEAR(applied().x(), 4.5, 0.05);
  api.hdDisable(phantom::hd::kSoftwareForceImpulseLimit);
  tick_force({-4.5, 0.0, 0.0});
  EXPECT_EQ(errors(), Errors{});
}

TEST_F(Forces, SpeedOverItsLimitDropsTheForceWhileItLasts) {
  set_motion({0.0, 0.0, 0.0, 0.12, 0.0, 0.0}, 0.5);
  open_and_start();
  set_number(phantom::hd::kSoftwareVelocityLimit, 200.0);
  Errors seen;
  int dropped = 0, slow_after = 0;
  for (int i = 0; i < 1500; ++i) {
    tick_force({0.0, 0.5, 0.0});
    const auto now = errors();
    seen.insert(seen.end(), now.begin(), now.end());
    const double speed = read_vector(phantom::hd::kCurrentVelocity).norm();
    if (motor(1) == 0.0) {
      ++dropped;
      EXPECT_GT(speed, 200.0);
    } else if (dropped > 0) {
      ++slow_after;
    }
  }
  EXPECT_EQ(seen, Errors{phantom::hd::kExceededMaxVelocity});  // once, at its start
  EXPECT_GT(dropped, 50);
  EXPECT_GT(slow_after, 50);
}

TEST_F(Forces, RampRisesFromZeroAtTheStartAndAfterAnError) {
  open();
  api.hdEnable(phantom::hd::kForceRamping);
  api.hdScheduleAsynchronous(
      [](void* self) {
        auto* t = static_cast<Forces*>(self);
        t->frame(
            [t] { t->api.hdSetDoublev(phantom::hd::kCurrentForce, Vec3(2.0, 0.0, 0.0).data()); });
        return phantom::hd::kCallbackContinue;
      },
      this, phantom::hd::kMaxPriority);
  api.hdStartScheduler();
  for (int ms = 1; ms <= 120; ++ms) {
    sim.step();
    EXPECT_NEAR(applied().x(), std::min(2.0, 0.02 * ms), 0.02) << ms;  // 20 N/s
  }
  EXPECT_NEAR(applied().x(), 2.0, 0.02);
  sim.inject(HDSIM_WARM_MOTORS, 1.0);
  sim.step();
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  sim.inject(HDSIM_WARM_MOTORS, 0.5);
  sim.step();
  EXPECT_NEAR(applied().x(), 0.02, 0.005);
}

TEST_F(Forces, MotorsWarmUpWithTheSquareOfTheForceAndDropIt) {
  ASSERT_EQ(sim.set_number("thermal_time_s", 1.0), 0);
  open_and_start();
  for (int i = 0; i < 3000; ++i)
    tick_force({0.0, 1.0, 0.0});
  const double half = state().temperature[1];
  EXPECT_NEAR(half, (1.0 / 1.4) * (1.0 / 1.4) * (1.0 - std::exp(-3.0)), 0.02);
  EXPECT_LT(state().temperature[0], 1e-3);
  EXPECT_EQ(errors(), Errors{});
  int ticks = 0;
  while (errors().empty() && ++ticks < 3000)
    tick_force({0.0, 4.0, 0.0});
  EXPECT_LT(ticks, 500);
  double reported[3];
  api.hdGetDoublev(phantom::hd::kMotorTemperature, reported);
  EXPECT_GE(reported[1], 0.99);
  tick_force({0.0, 1.0, 0.0});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
  EXPECT_EQ(errors(), Errors{});  // reported once
  for (int i = 0; i < 120; ++i)
    tick_force({0.0, 1.0, 0.0});
  EXPECT_NEAR(applied().y(), 1.0, 0.1);  // cooled
}

TEST_F(Forces, SafetySwitchTakesTheForce) {
  open_and_start();
  tick_force({1.0, 0.0, 0.0});
  sim.set_switches(0, 0, 0);
  tick_force({1.0, 0.0, 0.0});
  EXPECT_EQ(applied(), Vec3(Vec3::Zero()));
}

TEST_F(Forces, HandYieldsByItsStiffness) {
  ASSERT_EQ(sim.set_number("coulomb_nm", 0.0), 0);
  ASSERT_EQ(sim.set_number("gravity_m_per_s2", 0.0), 0);
  open_and_start();
  for (int i = 0; i < 2000; ++i)
    tick_force({1.5, 0.0, 0.0});
  EXPECT_NEAR(tip().x(), 1.5 / 300.0, 1e-4);
  EXPECT_NEAR(state().hand_force[0], -1.5, 0.02);
}

class Calibration : public SimulatedLibrary {};

TEST_F(Calibration, EncodersAreInvalidUntilReset) {
  device = api.hdInitDevice(nullptr);
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsManualInput);
  int style = 0;
  api.hdGetIntegerv(phantom::hd::kCalibrationStyle, &style);
  EXPECT_EQ(static_cast<phantom::hd::HDenum>(style), phantom::hd::kCalibrationEncoderReset);
  frame();
  EXPECT_GT(read_vector(phantom::hd::kCurrentPosition).norm(), 50.0);
  api.hdUpdateCalibration(phantom::hd::kCalibrationEncoderReset);
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationOk);
  frame();
  EXPECT_LT(read_vector(phantom::hd::kCurrentPosition).norm(), 0.05);
}

TEST_F(Calibration, LastsUntilThePowerGoes) {
  open();
  api.hdDisableDevice(device);
  device = api.hdInitDevice(nullptr);
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationOk);
  EXPECT_EQ(sim.power_cycle(), -1);  // not while it is open
  api.hdDisableDevice(device);
  EXPECT_EQ(sim.power_cycle(), 0);
  device = api.hdInitDevice(nullptr);
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsManualInput);
}

TEST_F(Calibration, LinksHeldWrongAtTheResetShiftThePosition) {
  ASSERT_EQ(sim.set_number("reset_error_thigh_rad", 0.05), 0);
  open();
  frame();
  EXPECT_NEAR(read_vector(phantom::hd::kCurrentPosition).y(), -0.05 * 215.0, 0.1);
}

TEST_F(Calibration, NotWhileForcesAreOn) {
  open_and_start();
  tick();
  api.hdUpdateCalibration(phantom::hd::kCalibrationEncoderReset);
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidOperation});
}

TEST_F(Calibration, InkwellNeedsTheStylusInItAndTheScheduler) {
  ASSERT_EQ(sim.set_model("omni"), 0);
  device = api.hdInitDevice(nullptr);
  EXPECT_STREQ(api.hdGetString(phantom::hd::kDeviceModelType), "PHANTOM Omni");
  api.hdStartScheduler();
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsManualInput);
  api.hdUpdateCalibration(phantom::hd::kCalibrationInkwell);
  EXPECT_EQ(errors(), Errors{phantom::hd::kInvalidOperation});
  sim.set_switches(0, 1, 1);
  sim.step();
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsUpdate);
  api.hdUpdateCalibration(phantom::hd::kCalibrationInkwell);
  EXPECT_EQ(errors(), Errors{});
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationOk);
}

TEST_F(Calibration, AutomaticOneRequestsAnUpdateAfterMotion) {
  ASSERT_EQ(sim.set_model("desktop"), 0);
  device = api.hdInitDevice(nullptr);
  api.hdStartScheduler();
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsManualInput);
  for (int i = 0; i < 60; ++i)
    sim.step();
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationNeedsUpdate);
  api.hdUpdateCalibration(phantom::hd::kCalibrationAuto);
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationOk);
}

}  // namespace
}  // namespace voxtouch::hd_sim_test
