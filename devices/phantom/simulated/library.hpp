#pragma once
/// The one state behind the exported functions: settings, device, servo loop, errors.
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

/// Every public function may be called from any thread, callbacks included; it takes the library's
/// lock, so none is real-time safe. Simulated time passes in ticks only: while the scheduler stands
/// the arm stands. Units are the interface's: mm, N, mNm, rad. What goes wrong is left on the stack
/// of errors, unless it says else.
class Library {
 public:
  /// Made at the first call and never destroyed: a servo thread may outlive main.
  static Library& instance();

  // --- device
  /// Opens the one device there is, by one of its usual names or null. kInvalidHandle: no such
  /// name, open already, or a fault was planted.
  phantom::hd::HHD init(phantom::hd::HDstring name);
  /// Forces off, frame closed, handle gone.
  void disable(phantom::hd::HHD device);
  /// There is one device only: says whether `device` is it.
  void make_current(phantom::hd::HHD device);
  /// kInvalidHandle where none is open.
  phantom::hd::HHD current_device();
  /// Takes a snapshot of the device, which all gets show until the next; no force is set yet.
  void begin_frame(phantom::hd::HHD device);
  /// What was set since `begin_frame` goes to the amplifier.
  void end_frame(phantom::hd::HHD device);
  /// hdEnable, hdDisable: force output, clamping, ramping, limits.
  void set_capability(phantom::hd::HDenum name, bool on);
  /// hdIsEnabled.
  bool capability_on(phantom::hd::HDenum name);
  /// A parameter's values; none of them where it cannot be read as `type`.
  Values get(phantom::hd::HDenum name, Type type);
  /// 0 where this cannot be set; the error is noted then.
  int count_of_set(phantom::hd::HDenum name);
  /// Sets a parameter, of as many values as `count_of_set` says.
  void set(phantom::hd::HDenum name, const Values& values);
  /// Null where there is no string of that name. Lives as long as the process.
  phantom::hd::HDstring string(phantom::hd::HDenum name);
  /// What the calibration needs next.
  phantom::hd::HDenum calibration();
  /// Calibrates, if the model does it so and its arm stands as it must for it.
  void calibrate(phantom::hd::HDenum style);
  /// The newest error, taken off the stack; kSuccess: there is none.
  phantom::hd::HDErrorInfo pop_error();
  /// Leaves an error that the caller has found.
  void fail(phantom::hd::HDerror code);

  // --- scheduler
  /// Starts the servo loop: a thread, or in virtual time ticks by `step`.
  void start();
  /// Ends it after the tick that runs; not from a callback.
  void stop();
  /// Ticks a second, of those that the model's bus has [Hz].
  void set_rate(phantom::hd::HDulong rate_hz);
  /// Runs `callback` each tick until it says that it is done. 0: there is no room.
  phantom::hd::HDSchedulerHandle schedule_asynchronous(phantom::hd::HDSchedulerCallback callback,
                                                       void* data, phantom::hd::HDushort priority);
  /// Takes a callback out, and waits until it is not running.
  void unschedule(phantom::hd::HDSchedulerHandle handle);

  // --- hooks. Throw std::runtime_error with a sentence.
  /// Changes settings and switches the device off and on again.
  template <class Change>
  void configure(Change change) {
    const Lock lock(mutex_);
    Settings candidate = settings_;
    change(candidate);
    power_on(candidate);
  }
  /// Where the hand goes, in the device's frame [m]: before the first tick the arm is put at its
  /// start, later the hand goes on from there.
  void set_motion(const Motion& motion);
  /// Another grip, from now on.
  void set_hand(const sim::OperatorConfig& hand);
  /// Buttons, safety switch and inkwell, from the next frame on.
  void set_switches(const Switches& switches);
  /// One tick of virtual time; false: it passed without callbacks.
  bool step();
  /// A fault of hdsim.h, with what its amount means there.
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
  std::string broken_;  // what was wrong with the environment variable
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
