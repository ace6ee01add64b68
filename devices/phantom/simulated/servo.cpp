// The servo loop of Library: its own thread in real time, or ticks made by the caller.
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "devices/phantom/simulated/library.hpp"

namespace voxtouch::hd_sim {
namespace {

thread_local int t_in_servo = 0;  // this thread is in a callback, or is the servo thread

struct InServo {
  InServo() noexcept { ++t_in_servo; }
  ~InServo() { --t_in_servo; }
  InServo(const InServo&) = delete;
  InServo& operator=(const InServo&) = delete;
};

// Periods that the arm makes up for after a stall of the whole process.
constexpr long kMaxMissed = 200;

}  // namespace

void Library::start() {
  Lock lock(mutex_);
  if (running_)
    return;
  if (std::exchange(fail_start_, false))
    return note(phantom::hd::kTimerError);
  dead_ = stopping_ = false;
  device_->amplifier.restart_ramp();
  running_ = true;
  mean_rate_hz_ = 1.0 / device_->period_s();
  if (settings_.virtual_time)
    return;
  try {
    thread_ = std::thread([this] { serve(); });
  } catch (const std::system_error&) {
    running_ = false;
    note(phantom::hd::kTimerError);
  }
}

void Library::stop() {
  Lock lock(mutex_);
  if (!running_ || stopping_)
    return;
  if (t_in_servo > 0)
    return note(phantom::hd::kInvalidOperation);  // it would wait for itself
  stopping_ = true;
  if (thread_.joinable()) {
    std::thread servo = std::move(thread_);
    lock.unlock();
    servo.join();
    lock.lock();
  }
  running_ = dead_ = stopping_ = false;
  device_->close_frame();
  device_->restart_ramp();
}

void Library::set_rate(phantom::hd::HDulong rate_hz) {
  const Lock lock(mutex_);
  const int substeps = substeps_at(device_->model(), rate_hz);
  if (substeps == 0)
    return note(phantom::hd::kInvalidValue);
  substeps_ = substeps;
  device_->set_substeps(substeps);
}

phantom::hd::HDSchedulerHandle Library::schedule_asynchronous(
    phantom::hd::HDSchedulerCallback callback, void* data, phantom::hd::HDushort priority) {
  const Lock lock(mutex_);
  if (callback == nullptr)
    return note(phantom::hd::kInvalidValue), 0;
  const phantom::hd::HDSchedulerHandle handle = callbacks_.add(callback, data, priority);
  if (handle == 0)
    note(phantom::hd::kSchedulerFull);
  return handle;
}

void Library::unschedule(phantom::hd::HDSchedulerHandle handle) {
  Lock lock(mutex_);
  if (!callbacks_.remove(handle, lock, t_in_servo > 0))
    note(phantom::hd::kInvalidOperation);
}

void Library::measure_rate(double seconds) noexcept {
  mean_rate_hz_ += 0.01 * (1.0 / seconds - mean_rate_hz_);
}

bool Library::step() {
  Lock lock(mutex_);
  if (!settings_.virtual_time || !running_)
    throw std::runtime_error(
        "simulated Phantom: hdsim_step needs virtual time and a running scheduler");
  if (t_in_servo > 0)
    throw std::runtime_error("simulated Phantom: hdsim_step was called from a callback");
  const int late = static_cast<int>(std::lround(std::exchange(late_s_, 0.0) * kSubstepHz));
  device_->advance(late);
  measure_rate(device_->period_s() + late * kSubstep);
  return tick(lock);
}

bool Library::tick(Lock& lock) {
  const bool missed = dead_ || skip_ticks_ > 0;
  if (missed) {
    if (skip_ticks_ > 0)
      --skip_ticks_;
    ++ticks_without_callbacks_;
  } else {
    device_->begin_tick(errors_);
    const InServo in_servo;
    callbacks_.run(lock);
  }
  device_->end_tick();
  return !missed;
}

/// Advances missed periods: the arm continued under the last force.
void Library::catch_up(Clock::time_point& due, Clock::duration period) {
  const Clock::time_point now = Clock::now();
  const long missed = (now - due) / period;
  if (missed <= 0)
    return;
  device_->advance(static_cast<int>(std::min(missed, kMaxMissed)) * device_->substeps());
  ticks_without_callbacks_ += static_cast<std::uint64_t>(missed);
  due += missed * period;
}

void Library::serve() {
  const InServo in_servo;
  Lock lock(mutex_);
  Clock::time_point due = Clock::now();
  Clock::time_point tick_start = due;
  while (!stopping_) {
    const auto period = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(device_->period_s()));
    const auto late = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(std::exchange(late_s_, 0.0)));
    due += period;
    lock.unlock();
    std::this_thread::sleep_until(due + late);
    lock.lock();
    if (stopping_)
      break;
    catch_up(due, period);
    const Clock::time_point now = Clock::now();
    measure_rate(std::max(1e-6, std::chrono::duration<double>(now - tick_start).count()));
    tick_start = now;
    tick(lock);
  }
}

}  // namespace voxtouch::hd_sim
