#pragma once
/// The state behind the exported functions: settings, device, servo loop, errors.
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "devices/phantom/simulated/device.hpp"
#include "devices/phantom/simulated/hdsim.h"
#include "devices/phantom/simulated/parameters.hpp"
#include "devices/phantom/simulated/scheduler.hpp"

namespace voxtouch::hd_sim {

/// Any thread, including callbacks, may call any public function. Each takes the library's lock, so
/// none is real-time safe. Simulated time passes in ticks only: while the scheduler is stopped the
/// arm does not move. Units are those of the interface: mm, N, mNm, rad. Errors are left on the
/// error stack, unless stated otherwise.
class Library {
 public:
  /// Created at the first call and never destroyed: a servo thread may outlive main.
  static Library& instance();

  // --- device
  /// Opens the only device, by one of its usual names or null. kInvalidHandle: unknown name,
  /// already open, or an injected fault.
  phantom::hd::HHD init(phantom::hd::HDstring name);
  /// Turns forces off, closes the frame and releases the handle.
  void disable(phantom::hd::HHD device);
  /// There is only one device: checks that `device` is it.
  void make_current(phantom::hd::HHD device);
  /// kInvalidHandle if no device is open.
  phantom::hd::HHD current_device();
  /// Takes a snapshot of the device for all get calls until the next one; no force is set yet.
  void begin_frame(phantom::hd::HHD device);
  /// Passes the values set since `begin_frame` to the amplifier.
  void end_frame(phantom::hd::HHD device);
  /// hdEnable, hdDisable: force output, clamping, ramping, limits.
  void set_capability(phantom::hd::HDenum name, bool on);
  /// hdIsEnabled.
  bool capability_on(phantom::hd::HDenum name);
  /// The values of a parameter; empty if it cannot be read as `type`.
  Values get(phantom::hd::HDenum name, Type type);
  /// 0 if this parameter cannot be set; the error is then recorded.
  int count_of_set(phantom::hd::HDenum name);
  /// Sets a parameter with `count_of_set` values.
  void set(phantom::hd::HDenum name, const Values& values);
  /// Null for an unknown name. Valid until the process ends.
  phantom::hd::HDstring string(phantom::hd::HDenum name);
  /// The next calibration step.
  phantom::hd::HDenum calibration();
  /// Calibrates, if the model supports the style and the arm is in the required pose.
  void calibrate(phantom::hd::HDenum style);
  /// Removes and returns the newest error; kSuccess if there is none.
  phantom::hd::HDErrorInfo pop_error();
  /// Records an error found by the caller.
  void fail(phantom::hd::HDerror code);

  // --- scheduler
  /// Starts the servo loop: a thread, or in virtual time ticks by `step`.
  void start();
  /// Ends it after the present tick; not from a callback.
  void stop();
  /// Rate of the ticks, one of those of the model's bus [Hz].
  void set_rate(phantom::hd::HDulong rate_hz);
  /// Runs `callback` in each tick until it returns done. 0: no room.
  phantom::hd::HDSchedulerHandle schedule_asynchronous(phantom::hd::HDSchedulerCallback callback,
                                                       void* data, phantom::hd::HDushort priority);
  /// Removes a callback, and waits until it is not running.
  void unschedule(phantom::hd::HDSchedulerHandle handle);

  // --- hooks. Throw std::runtime_error with a sentence.
  /// Changes settings and power-cycles the device.
  template <class Change>
  void configure(Change change) {
    const Lock lock(mutex_);
    Settings candidate = settings_;
    change(candidate);
    power_on(candidate);
  }
  /// Sets the motion of the hand, in the device's frame [m]. Until the first tick the arm is moved
  /// to its start; later the hand continues from its pose.
  void set_motion(const Motion& motion);
  /// Changes the grip from now on.
  void set_hand(const sim::OperatorConfig& hand);
  /// Sets buttons, safety switch and inkwell, from the next frame on.
  void set_switches(const Switches& switches);
  /// Makes one tick of virtual time; returns false if it had no callbacks.
  bool step();
  /// Injects a fault of hdsim.h with its amount.
  void inject(int fault, double amount);
  /// The true state, in SI units.
  void read_state(hdsim_state& state);

 private:
  using Lock = CallbackList::Lock;
  using Clock = std::chrono::steady_clock;

  Library();
  void power_on(const Settings& settings);
  bool usable(phantom::hd::HHD device);
  bool opened();
  bool serves() const noexcept { return running_ && !dead_; }
  void note(phantom::hd::HDerror code);
  bool tick(Lock& lock);
  void serve();
  void catch_up(Clock::time_point& due, Clock::duration period);
  void measure_rate(double seconds) noexcept;

  std::recursive_mutex mutex_;
  Settings settings_;
  std::unique_ptr<Device> device_;
  std::string broken_;  // error in the environment variable
  bool open_ = false;
  ErrorStack errors_;

  CallbackList callbacks_;
  std::thread thread_;
  bool running_ = false, stopping_ = false, dead_ = false;
  int substeps_ = 8;
  double mean_rate_hz_ = 0.0;

  phantom::hd::HDerror fail_init_ = phantom::hd::kSuccess;
  bool fail_start_ = false;
  long skip_ticks_ = 0;
  double late_s_ = 0.0;
  std::uint64_t ticks_without_callbacks_ = 0;
};

}  // namespace voxtouch::hd_sim
