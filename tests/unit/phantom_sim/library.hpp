#pragma once
/// The simulated library as a driver sees it: opened by path, every function found by its name.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/types/geometry.hpp"
#include "devices/operator/hand.hpp"
#include "devices/operator/hand_file.hpp"
#include "devices/phantom/hdapi.hpp"
#include "devices/phantom/simulated/hdsim.h"

namespace voxtouch::hd_sim_test {

struct Hooks {
  decltype(&hdsim_defaults) defaults;
  decltype(&hdsim_power_cycle) power_cycle;
  decltype(&hdsim_use_virtual_time) use_virtual_time;
  decltype(&hdsim_set_model) set_model;
  decltype(&hdsim_set_seed) set_seed;
  decltype(&hdsim_set_number) set_number;
  decltype(&hdsim_set_motion) set_motion;
  decltype(&hdsim_set_hand) set_hand;
  decltype(&hdsim_set_switches) set_switches;
  decltype(&hdsim_step) step;
  decltype(&hdsim_inject) inject;
  decltype(&hdsim_read_state) read_state;
  decltype(&hdsim_last_message) last_message;
};

inline void* handle() {
  static void* const library = dlopen(VOXTOUCH_HD_SIM_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
  return library;
}

template <class F>
void find(F& f, const char* name) {
  f = reinterpret_cast<F>(dlsym(handle(), name));
  ASSERT_NE(f, nullptr) << name;
}

/// A hand with all features: tremor, carried load, a firmer grip after 0.5 s, and a release.
inline sim::OperatorConfig shaky_hand(
    double release_time_s = std::numeric_limits<double>::infinity()) {
  sim::OperatorConfig hand;
  hand.mass_kg = 0.1, hand.damping_ns_per_m = 4.0, hand.stiffness_n_per_m = 300.0;
  hand.release_time_s = release_time_s, hand.grip_change_time_s = 0.5, hand.grip_factor = 2.0;
  hand.tremor_n = 0.2, hand.tremor_bandwidth_hz = 10.0;
  hand.carries_tool = true;
  return hand;
}

/// Virtual time, the usual model and hand; a device is open and calibrated after `open`.
class SimulatedLibrary : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(handle(), nullptr) << dlerror();
    ASSERT_EQ(phantom::hd::resolve_api(api, [](const char* name) { return dlsym(handle(), name); }),
              "");
    find(sim.defaults, "hdsim_defaults");
    find(sim.power_cycle, "hdsim_power_cycle");
    find(sim.use_virtual_time, "hdsim_use_virtual_time");
    find(sim.set_model, "hdsim_set_model");
    find(sim.set_seed, "hdsim_set_seed");
    find(sim.set_number, "hdsim_set_number");
    find(sim.set_motion, "hdsim_set_motion");
    find(sim.set_hand, "hdsim_set_hand");
    find(sim.set_switches, "hdsim_set_switches");
    find(sim.step, "hdsim_step");
    find(sim.inject, "hdsim_inject");
    find(sim.read_state, "hdsim_read_state");
    find(sim.last_message, "hdsim_last_message");
    shut();
    ASSERT_EQ(sim.defaults(), 0) << sim.last_message();
    ASSERT_EQ(sim.use_virtual_time(1), 0) << sim.last_message();
  }
  void TearDown() override { shut(); }

 public:  // callbacks are no members
  /// As a driver would, up to the scheduler's start; forces on, no ramp.
  void open() {
    device = api.hdInitDevice(phantom::hd::kDefaultDevice);
    ASSERT_NE(device, phantom::hd::kInvalidHandle);
    api.hdUpdateCalibration(phantom::hd::kCalibrationEncoderReset);
    api.hdEnable(phantom::hd::kForceOutput);
    ASSERT_EQ(error(), phantom::hd::kSuccess);
  }
  void open_and_start() {
    open();
    api.hdScheduleAsynchronous(run_tick, this, phantom::hd::kMaxPriority);
    api.hdStartScheduler();
    ASSERT_EQ(error(), phantom::hd::kSuccess);
  }
  void shut() {
    if (api.hdStopScheduler == nullptr)
      return;
    api.hdStopScheduler();
    if (api.hdGetCurrentDevice() != phantom::hd::kInvalidHandle)
      api.hdDisableDevice(api.hdGetCurrentDevice());
    while (error() != phantom::hd::kSuccess) {
    }
  }

  phantom::hd::HDerror error() { return api.hdGetError().error_code; }
  std::vector<phantom::hd::HDerror> errors() {
    std::vector<phantom::hd::HDerror> all;
    for (phantom::hd::HDerror e = error(); e != phantom::hd::kSuccess; e = error())
      all.push_back(e);
    return all;
  }

  /// One tick with this in its callback.
  int tick(std::function<void()> work = {}) {
    work_ = std::move(work);
    const int result = sim.step();
    work_ = {};
    return result;
  }
  /// One tick with a frame that commands this force [N], as doubles.
  int tick_force(const Vec3& force) {
    return tick([this, force] {
      frame([&] { api.hdSetDoublev(phantom::hd::kCurrentForce, force.data()); });
    });
  }
  void frame(const std::function<void()>& work = {}) {
    api.hdBeginFrame(device);
    if (work)
      work();
    api.hdEndFrame(device);
  }
  hdsim_state state() {
    hdsim_state s{};
    EXPECT_EQ(sim.read_state(&s, sizeof s), 0);
    return s;
  }
  Vec3 applied() {
    const hdsim_state s = state();
    return {s.motor_force[0], s.motor_force[1], s.motor_force[2]};
  }
  Vec3 tip() {
    const hdsim_state s = state();
    return {s.tip[0], s.tip[1], s.tip[2]};
  }
  Vec3 read_vector(phantom::hd::HDenum name) {
    Vec3 v = Vec3::Constant(-1.0);
    api.hdGetDoublev(name, v.data());
    return v;
  }
  int set_motion(const Motion& motion) {
    hand::HandFile file;
    file.motion = motion;
    return sim.set_motion(hand::to_text(file).c_str());
  }
  int set_motion(const std::vector<double>& points, double speed = 0.1) {
    Motion motion;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3)
      motion.path.emplace_back(points[i], points[i + 1], points[i + 2]);
    motion.speed_m_per_s = speed;
    return set_motion(motion);
  }
  int set_hand(const sim::OperatorConfig& hand) {
    hand::HandFile file;
    file.hand = hand;
    file.motion.path = {Vec3::Zero()};
    return sim.set_hand(hand::to_text(file).c_str());
  }

  phantom::hd::Api api;
  Hooks sim{};
  phantom::hd::HHD device = phantom::hd::kInvalidHandle;

 private:
  static phantom::hd::HDCallbackCode run_tick(void* self) {
    const auto& work = static_cast<SimulatedLibrary*>(self)->work_;
    if (work)
      work();
    return phantom::hd::kCallbackContinue;
  }
  std::function<void()> work_;
};

}  // namespace voxtouch::hd_sim_test
