// The interface's rules, as the driver keeps them tick by tick.
#include <algorithm>
#include <chrono>
#include <thread>

#include "fixture.hpp"

namespace voxtouch::phantom_test {
namespace {

using Calls = std::vector<std::string>;

class Rules : public DriverTest {
 protected:
  void SetUp() override {
    DriverTest::SetUp();
    open_driver();
  }
  /// The calls of the ticks from here on.
  static Calls in_ticks() {
    return Spy::instance().calls({"begin", "end", "set", "enable", "disable"});
  }
};

TEST_F(Rules, ATickIsOneFrameAndTheForceIsSetWithinIt) {
  ASSERT_TRUE(driver->read(10ms));
  ASSERT_TRUE(driver->write(push(1.25)));
  Spy::instance().reset();
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(in_ticks(), (Calls{"begin", "set 2700 1.250000", "end"}));
}

TEST_F(Rules, ATickWithoutACommandSetsNothing) {
  ASSERT_TRUE(driver->read(10ms));
  Spy::instance().reset();
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(in_ticks(), (Calls{"begin", "end"}));
}

TEST_F(Rules, OfTwoCommandsTheNewerCounts) {
  ASSERT_TRUE(driver->read(10ms));
  ASSERT_TRUE(driver->write(push(1.0)));
  ASSERT_TRUE(driver->write(push(2.0)));
  Spy::instance().reset();
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(Spy::instance().calls({"set"}), Calls{"set 2700 2.000000"});
}

TEST_F(Rules, RefusedCommandRevokesTheLast) {
  ASSERT_TRUE(driver->read(10ms));
  ASSERT_TRUE(driver->write(push(1.0)));
  EXPECT_FALSE(driver->write(push(std::nan(""))));
  Spy::instance().reset();
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(Spy::instance().calls({"set"}), Calls{});
}

TEST_F(Rules, ErrorsAreTakenUntilThereAreNone) {
  for (int i = 0; i < 100; ++i)
    Spy::instance().plant_error(phantom::hd::kForceError);
  ASSERT_TRUE(driver->read(10ms));
  EXPECT_EQ(driver->servo().errors().count(), 100u);
  EXPECT_EQ(state().errors_waiting, 0u);
}

TEST_F(Rules, RampingAndClampingAreOnWhileForceIs) {
  for (const phantom::hd::HDenum what :
       {phantom::hd::kForceOutput, phantom::hd::kForceRamping, phantom::hd::kMaxForceClamping})
    EXPECT_TRUE(api.hdIsEnabled(what)) << what;
}

TEST_F(Rules, WarmMotorsGetLessForceDownToTheContinuousOne) {
  push_until_steady({8.0, 0.0, 0.0});
  ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 0.85), 0);
  double last = 8.5;
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 0.85), 0);
    const Cycle t = cycle(push(8.0));
    ASSERT_TRUE(t.written);
    ASSERT_LE(driver->sample().force_limit_n, last);
    last = driver->sample().force_limit_n;
  }
  EXPECT_EQ(last, 1.4);
  EXPECT_NEAR(applied().x(), 1.4, 0.05);
  EXPECT_GT(driver->servo().counts().thermal.load(), 1000u);
  for (int i = 0; i < 3000; ++i) {
    ASSERT_EQ(sim.inject(HDSIM_WARM_MOTORS, 0.3), 0);
    ASSERT_TRUE(cycle(push(8.0)).written);
  }
  EXPECT_EQ(driver->sample().force_limit_n, 8.5);
  EXPECT_NEAR(applied().x(), 8.0, 0.4);
  EXPECT_EQ(driver->servo().errors().count(), 0u);  // the device never had to drop it
}

TEST_F(Rules, TheClampKeepsMotorsFromTheHeatThatDropsTheForce) {
  double hottest = 0.0;
  for (int i = 0; i < 8000; ++i) {
    ASSERT_TRUE(cycle(push(0.0, 8.0)).written) << i;
    hottest = std::max(hottest, state().temperature[1]);
  }
  EXPECT_GT(hottest, 0.7);
  EXPECT_LT(hottest, 1.0);
  EXPECT_EQ(driver->servo().errors().dropped(), 0u);
}

TEST_F(Rules, DeviceWithoutTemperatureIsNotClamped) {
  EXPECT_EQ(driver->facts().temperatures, 3);
  driver.reset();
  Spy::instance().change_reading([](phantom::hd::HDenum name, double* values) {
    if (name == phantom::hd::kMotorTemperature)
      values[0] = std::nan("");
  });
  open_driver();
  EXPECT_EQ(driver->facts().temperatures, 0);
  push_until_steady({8.0, 0.0, 0.0});
  EXPECT_EQ(driver->sample().force_limit_n, 8.5);
}

class Servo : public DriverTest {};

TEST_F(Servo, TickWakesItsWaiter) {
  const phantom::HdLibrary& library = phantom::HdLibrary::load(options.library);
  phantom::HdSession session(library, options);
  phantom::PhantomServo servo(library, session.device(), session.facts(),
                              phantom::describe_phantom(session.facts()), 50.0, true);
  phantom::ServoSample sample;
  EXPECT_FALSE(servo.take(sample, {}));
  std::jthread ticker([&servo] {
    std::this_thread::sleep_for(50ms);
    phantom::PhantomServo::run(&servo);
  });
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(servo.take(sample, start + 20s));
  EXPECT_LT(std::chrono::steady_clock::now() - start, 10s);
  EXPECT_TRUE(sample.sample.pose.finite());
}

}  // namespace
}  // namespace voxtouch::phantom_test
