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

/// Every public function may be called from any thread, callbacks included. Simulated time passes in ticks only: while the
/// scheduler stands the arm stands.
class Library {
 public:
  /// Made at the first call and never destroyed: a servo thread may outlive main.
  static Library& instance();

  // --- device
  phantom::hd::HHD init(phantom::hd::HDstring name);
  void disable(phantom::hd::HHD device);
  void make_current(phantom::hd::HHD device);
  phantom::hd::HHD current_device();
  void begin_frame(phantom::hd::HHD device);
  void end_frame(phantom::hd::HHD device);
  void set_capability(phantom::hd::HDenum name, bool on);
  bool capability_on(phantom::hd::HDenum name);
  Values get(phantom::hd::HDenum name, Type type);
  /// 0 where this cannot be set as `type`; the error is noted then.
  int count_of_set(phantom::hd::HDenum name, Type type);
  void set(phantom::hd::HDenum name, const Values& values);
  phantom::hd::HDstring string(phantom::hd::HDenum name);
  phantom::hd::HDenum calibration(bool style_only);
  void calibrate(phantom::hd::HDenum style);
  void scale_gimbal(const Vec3& scale, double* transform);
  phantom::hd::HDErrorInfo pop_error();
  void fail(phantom::hd::HDerror code);

  // --- scheduler
  void start();
  void stop();
  void set_rate(phantom::hd::HDulong rate_hz);
  void schedule_synchronous(phantom::hd::HDSchedulerCallback callback, void* data, phantom::hd::HDushort priority);
  phantom::hd::HDSchedulerHandle schedule_asynchronous(phantom::hd::HDSchedulerCallback callback, void* data,
                                                       phantom::hd::HDushort priority);
  void unschedule(phantom::hd::HDSchedulerHandle handle);
  bool wait(phantom::hd::HDSchedulerHandle handle, phantom::hd::HDWaitCode code);
  double time_stamp();

  // --- hooks. Throw std::runtime_error with a sentence.
  /// Changes settings and switches the device off and on again.
  template <class Change>
  void configure(Change change) {
    const Lock lock(mutex_);
    Settings trial = settings_;
    change(trial);
    power_on(trial);
  }
  void set_motion(const Motion& motion);
  void set_hand(const sim::OperatorConfig& hand);
  void set_switches(const Switches& switches);
  bool step();  ///< false: the tick passed without callbacks
  void inject(int fault, double amount);
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
  void run_at_once(Lock& lock, phantom::hd::HDSchedulerCallback callback, void* data);
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
  Rates rates_;
  Clock::time_point tick_start_{};

  phantom::hd::HDerror fail_init_ = phantom::hd::kSuccess;
  bool fail_start_ = false;
  long skip_ticks_ = 0;
  double late_s_ = 0.0;
  std::uint64_t ticks_without_callbacks_ = 0;
};

}  // namespace voxtouch::hd_sim
