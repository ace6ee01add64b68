#pragma once
/// The driver on the simulated library; virtual time by default.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "devices/phantom/phantom_driver.hpp"
#include "spy.hpp"
#include "tests/unit/phantom_sim/library.hpp"

namespace voxtouch::phantom_test {

using namespace std::chrono_literals;

class DriverTest : public hd_sim_test::SimulatedLibrary {
 protected:
  void SetUp() override {
    Spy::instance().reset();
    SimulatedLibrary::SetUp();
    options.library = VOXTOUCH_HD_SIM_LIBRARY;
  }
  void TearDown() override {
    driver.reset();
    Spy::instance().reset();
    SimulatedLibrary::TearDown();
  }

  void open_driver() { driver = std::make_unique<phantom::PhantomDriver>(options); }
  /// The sentence of an opening that fails; empty: it opened.
  std::string refusal() {
    try {
      open_driver();
    } catch (const devices::DeviceOpenError& error) {
      return error.what();
    }
    return "";
  }
  static Wrench push(double x, double y = 0.0, double z = 0.0) {
    return {Vec3(x, y, z), Vec3::Zero()};
  }

  struct Cycle {
    devices::DeviceResult<devices::DeviceSample> sample;
    devices::DeviceResult<void> written;
    double force = 0.0;  ///< at the motors, after the tick
  };
  /// One period of a device loop. It continues to write after any error: the driver must stay safe.
  Cycle cycle(const Wrench& command) {
    Cycle t{driver->read(10ms), {}};
    t.force = applied().norm();
    if (t.sample)
      t.written = driver->write(command);
    return t;
  }
  /// Until the ramp is over: the motors give `force`.
  void push_until_steady(const Vec3& force) {
    for (int i = 0; i < 450; ++i) {
      const Cycle t = cycle({force, Vec3::Zero()});
      ASSERT_TRUE(t.sample);
      ASSERT_TRUE(t.written) << devices::name_of(t.written.error());
    }
    ASSERT_NEAR((applied() - force).norm(), 0.0, 0.05 * force.norm());
  }

  phantom::PhantomOptions options;
  std::unique_ptr<phantom::PhantomDriver> driver;
};

}  // namespace voxtouch::phantom_test
