#include "devices/phantom/phantom_servo.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "devices/limits.hpp"
#include "devices/phantom/hd_orientation.hpp"

namespace voxtouch::phantom {
namespace {

constexpr double kMilli = 1e-3;  // m per mm, Nm per mNm
// After a longer gap a difference of positions is not the present velocity.
constexpr std::int64_t kGapPeriods = 5;
constexpr double kNoArmReachesM = 10.0;
constexpr auto kRelaxed = std::memory_order_relaxed;

void count(std::atomic<std::uint64_t>& counter) noexcept { counter.fetch_add(1, kRelaxed); }

}  // namespace

PhantomServo::PhantomServo(const HdLibrary& library, hd::HHD device, const PhantomFacts& facts,
                           const DeviceDescription& description, double velocity_cutoff_hz,
                           bool virtual_time) noexcept
    : api_(library.api()),
      hooks_(library.hooks()),
      device_(device),
      temperatures_(facts.temperatures),
      virtual_time_(virtual_time),
      max_torque_nm_(description.max_torque_nm),
      period_ns_(std::llround(1e9 / description.rate_hz)),
      clamp_(description.max_force_n, continuous_force_n(facts)),
      twist_(velocity_cutoff_hz),
      last_tick_(Clock::now().time_since_epoch().count()) {}

void PhantomServo::set_rate(double rate_hz) noexcept {
  period_ns_.store(std::llround(1e9 / rate_hz), kRelaxed);
}

hd::HDCallbackCode PhantomServo::run(void* self) noexcept {
  static_cast<PhantomServo*>(self)->tick();
  return hd::kCallbackContinue;
}

void PhantomServo::tick() noexcept {
  errors_.drain(api_);  // heat and speed are checked first in a tick
  const std::uint64_t known = errors_.count();
  const std::int64_t now = now_ns();
  api_.hdBeginFrame(device_);
  read_frame();
  errors_.drain(api_);
  update(now, errors_.count() == known && errors_.fatal() == hd::kSuccess);
  answer();
  api_.hdEndFrame(device_);
  errors_.drain(api_);
  if (errors_.fatal() != hd::kSuccess && !std::exchange(ended_, true))
    api_.hdDisable(hd::kForceOutput);
  publish();
}

void PhantomServo::publish() noexcept {
  count(counts_.ticks);
  last_tick_.store(Clock::now().time_since_epoch().count(), std::memory_order_release);
  if (samples_.put(seen_))
    count(counts_.superseded);
  else
    wake_up_.post();  // if the previous sample was not taken, its post is still pending
}

std::int64_t PhantomServo::now_ns() const noexcept {
  if (!virtual_time_)
    return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
  hdsim_state state{};
  hooks_.read_state(&state, sizeof state);
  return std::llround(1e9 * state.time);
}

// --- input

/// A value that the library leaves unset is NaN and is detected as such.
void PhantomServo::read_frame() noexcept {
  raw_ = Raw{};
  api_.hdGetDoublev(hd::kCurrentPosition, raw_.position.data());
  api_.hdGetDoublev(hd::kCurrentTransform, raw_.transform.data());
  api_.hdGetIntegerv(hd::kCurrentButtons, &raw_.buttons);
  if (temperatures_ > 0)
    api_.hdGetDoublev(hd::kMotorTemperature, raw_.temperature.data());
}

void PhantomServo::update(std::int64_t now_ns, bool frame_good) noexcept {
  const std::int64_t period_ns = period_ns_.load(kRelaxed), elapsed_ns = now_ns - last_ns_;
  if (!std::exchange(first_, false) && 2 * elapsed_ns > 3 * period_ns)
    count(counts_.late);
  last_ns_ = now_ns;
  devices::DeviceSample& s = seen_.sample;
  s.time_ns = now_ns;
  s.buttons = static_cast<std::uint32_t>(raw_.buttons);
  s.pose_valid = update_pose() && frame_good;
  if (elapsed_ns > kGapPeriods * period_ns)
    twist_.restart();
  if (s.pose_valid) {
    s.twist = twist_.update(s.pose, 1e-9 * static_cast<double>(elapsed_ns));
  } else {
    count(counts_.invalid_poses);
    twist_.restart();
    s.twist = {};
  }
  seen_.force_limit_n =
      clamp_.update(std::span(raw_.temperature).first(static_cast<std::size_t>(temperatures_)),
                    std::exchange(set_n_, 0.0));
}

/// Keeps the previous pose if the frame contains no valid one.
bool PhantomServo::update_pose() noexcept {
  Pose pose;
  pose.position = kMilli * Vec3(raw_.position[0], raw_.position[1], raw_.position[2]);
  // Each separately: the maximum of three may be a number although one of them is NaN.
  if (!(pose.position.cwiseAbs().array() < kNoArmReachesM).all())
    return false;
  if (!orientation_of(raw_.transform.data(), pose.orientation))
    return false;
  // The sign nearer to the last orientation, so that interpolation has no jump.
  if (pose.orientation.dot(seen_.sample.pose.orientation) < 0.0)
    pose.orientation.coeffs() *= -1.0;
  seen_.sample.pose = pose;
  return true;
}

// --- output

void PhantomServo::answer() noexcept {
  Command command;
  if (!commands_.take(command) || !command.active)
    return;
  const bool same = command.errors == errors_.count() && errors_.fatal() == hd::kSuccess;
  if (!same || !seen_.sample.pose_valid)
    return count(counts_.withheld);
  if (force_off_.exchange(false, std::memory_order_acq_rel))
    api_.hdEnable(hd::kForceOutput);
  set(command.wrench);
}

/// The last check, at the call of the library.
void PhantomServo::set(const Wrench& wrench) noexcept {
  Vec3 force = wrench.force;
  if (clamp_length(force, clamp_.limit_n()))
    count(counts_.thermal);
  api_.hdSetDoublev(hd::kCurrentForce, force.data());
  set_n_ = length_of(force);
  if (max_torque_nm_ > 0.0) {
    Vec3 torque = wrench.torque;
    clamp_length(torque, max_torque_nm_ * clamp_.fraction());
    torque /= kMilli;
    api_.hdSetDoublev(hd::kCurrentTorque, torque.data());
  }
  count(counts_.applied);
}

// --- the side of the other thread

bool PhantomServo::take(ServoSample& out, Clock::time_point deadline) noexcept {
  for (;;) {
    if (samples_.take(out)) {
      wake_up_.clear();
      return true;
    }
    if (!wake_up_.wait_until(deadline))
      return samples_.take(out);
  }
}

/// In this order: a tick in between sets a force that the device does not display, and the next one
/// turns it on.
void PhantomServo::force_off() noexcept {
  api_.hdDisable(hd::kForceOutput);
  force_off_.store(true, std::memory_order_release);
}

PhantomServo::Clock::duration PhantomServo::silence() const noexcept {
  return Clock::now().time_since_epoch() -
         Clock::duration(last_tick_.load(std::memory_order_acquire));
}

}  // namespace voxtouch::phantom
