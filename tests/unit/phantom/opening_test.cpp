// Ways to open, and the state after a failure.
#include "fixture.hpp"

namespace voxtouch::phantom_test {
namespace {

using Calls = std::vector<std::string>;

class Opening : public DriverTest {
 protected:
  void expect_nothing_open() {
    const hdsim_state s = state();
    EXPECT_FALSE(s.device_open);
    EXPECT_FALSE(s.scheduler_running);
    EXPECT_EQ(s.callbacks, 0u);
    EXPECT_EQ(s.errors_waiting, 0u);
  }
  Calls steps() const {
    return Spy::instance().calls(
        {"init", "calibrate", "enable", "disable", "schedule", "start", "stop", "unschedule"});
  }
};

TEST_F(Opening, FollowsTheOrderOfTheInterface) {
  open_driver();
  EXPECT_EQ(steps(), (Calls{"init Default Device", "calibrate 1", "enable 4002", "enable 4001",
                            "enable 4000", "schedule 65535", "start"}));
  Spy::instance().reset();
  driver.reset();
  EXPECT_EQ(steps(), (Calls{"disable 4000", "stop", "unschedule", "disable-device"}));
  expect_nothing_open();
}

TEST_F(Opening, ServoCalibrationPrecedesForceOutput) {
  ASSERT_EQ(sim.set_model("desktop"), 0);
  open_driver();
  EXPECT_EQ(steps(), (Calls{"init Default Device", "schedule 65535", "start", "calibrate 2",
                            "enable 4002", "enable 4001", "enable 4000"}));
  EXPECT_EQ(driver->description().max_force_n, 7.9);
  EXPECT_TRUE(driver->read(10ms)->pose_valid);
}

TEST_F(Opening, AStylusInItsInkwellIsCalibrated) {
  ASSERT_EQ(sim.set_model("omni"), 0);
  sim.set_switches(0, 1, 1);
  open_driver();
  EXPECT_EQ(Spy::instance().calls({"calibrate"}), Calls{"calibrate 4"});
  EXPECT_EQ(api.hdCheckCalibration(), phantom::hd::kCalibrationOk);
  EXPECT_EQ(driver->description().model, "PHANTOM Omni");
  EXPECT_EQ(driver->description().max_force_n, 3.3);
  EXPECT_DOUBLE_EQ(driver->description().max_stiffness_n_per_m, 700.0);
}

TEST_F(Opening, StylusOutOfItsInkwellIsRequested) {
  ASSERT_EQ(sim.set_model("omni"), 0);
  options.calibration_timeout_s = 0.05;
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("inkwell"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("0.05"), std::string::npos) << sentence;
  expect_nothing_open();
  sim.set_switches(0, 1, 1);
  EXPECT_EQ(refusal(), "");
}

TEST_F(Opening, EncodersAreSetToZeroOnceUntilThePowerGoes) {
  open_driver();
  driver.reset();
  Spy::instance().reset();
  open_driver();
  EXPECT_EQ(Spy::instance().calls({"calibrate"}), Calls{});
  driver.reset();
  options.encoder_reset = phantom::EncoderReset::kAlways;
  open_driver();
  EXPECT_EQ(Spy::instance().calls({"calibrate"}), Calls{"calibrate 1"});
}

TEST_F(Opening, NamesAreTriedInOrder) {
  options.name = "Left Phantom";
  Spy::instance().fail_init(phantom::hd::kCommConfigError, 3);
  open_driver();
  EXPECT_EQ(Spy::instance().calls({"init"}), (Calls{"init Left Phantom", "init Default Device",
                                                    "init Default PHANToM", "init null"}));
}

TEST_F(Opening, MissingDeviceIsReportedWithTriedNames) {
  options.name = "Left Phantom";
  Spy::instance().fail_init(phantom::hd::kCommConfigError, 4);
  const std::string sentence = refusal();
  for (const char* part :
       {"Left Phantom", "Default Device", "Default PHANToM", "no name", "0x0303", "power, cable"})
    EXPECT_NE(sentence.find(part), std::string::npos) << sentence;
  expect_nothing_open();
  EXPECT_EQ(refusal(), "");
}

TEST_F(Opening, MissingLicenceIsReportedAtOnce) {
  ASSERT_EQ(sim.inject(HDSIM_FAIL_INIT, phantom::hd::kInvalidLicense), 0);
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("licence"), std::string::npos) << sentence;
  EXPECT_EQ(Spy::instance().calls({"init"}).size(), 1u);
}

TEST_F(Opening, DeviceInUseIsReportedAtOnce) {
  ASSERT_NE(api.hdInitDevice(nullptr),
            phantom::hd::kInvalidHandle);  // another program in this process
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("in use"), std::string::npos) << sentence;
}

TEST_F(Opening, SecondOneInAProcessIsRefused) {
  open_driver();
  push_until_steady({2.0, 0.0, 0.0});
  try {
    phantom::PhantomDriver second(options);
    FAIL() << "a second one opened";
  } catch (const devices::DeviceOpenError& error) {
    EXPECT_NE(std::string(error.what()).find("already"), std::string::npos) << error.what();
  }
  EXPECT_NEAR(cycle(push(2.0)).force, 2.0, 0.1);
  driver.reset();
  EXPECT_EQ(refusal(), "");
}

TEST_F(Opening, FailedServoLoopIsReportedAndClosed) {
  ASSERT_EQ(sim.inject(HDSIM_FAIL_START, 0), 0);
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("servo loop"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("0x0304"), std::string::npos) << sentence;
  expect_nothing_open();
  EXPECT_EQ(Spy::instance().calls({"unschedule", "disable-device"}),
            (Calls{"unschedule", "disable-device"}));
  EXPECT_EQ(refusal(), "");
}

TEST_F(Opening, SilentServoLoopIsReported) {
  ASSERT_EQ(sim.use_virtual_time(0), 0);
  Spy::instance().swallow_start();
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("servo loop"), std::string::npos) << sentence;
  expect_nothing_open();
}

TEST_F(Opening, DeviceUnpluggedDuringOpeningIsReported) {
  ASSERT_EQ(sim.use_virtual_time(0), 0);
  ASSERT_EQ(sim.inject(HDSIM_COMM_ERROR, -1), 0);
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("0x0302"), std::string::npos) << sentence;
  expect_nothing_open();
}

TEST_F(Opening, RateIsSetAndReadFromTheDevice) {
  options.rate_hz = 500;
  open_driver();
  EXPECT_EQ(driver->description().rate_hz, 500.0);
  EXPECT_EQ(driver->description().delay_s, 2e-3);
  EXPECT_EQ(driver->read(10ms)->time_ns, 0);
  EXPECT_EQ(driver->read(10ms)->time_ns, 2'000'000);
  EXPECT_EQ(driver->servo().counts().late.load(), 0u);
}

TEST_F(Opening, UnsupportedRateIsReported) {
  options.rate_hz = 700;
  const std::string sentence = refusal();
  EXPECT_NE(sentence.find("700 Hz"), std::string::npos) << sentence;
  expect_nothing_open();
}

}  // namespace
}  // namespace voxtouch::phantom_test
