#include "devices/force_guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/types/clamp.hpp"

namespace voxtouch::devices {
namespace {

constexpr double kSecondsPerNs = 1e-9;
// One hour: longer than hold, fade and ramps. Sums cannot overflow.
constexpr std::int64_t kLongestGapNs = 3'600'000'000'000;

/// Time from `earlier` to `later`, at most kLongestGapNs. Unsigned arithmetic: the difference of
/// two stamps may not fit the signed type.
std::int64_t gap_ns(std::int64_t earlier, std::int64_t later) noexcept {
  const std::uint64_t gap = static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
  return static_cast<std::int64_t>(std::min(gap, static_cast<std::uint64_t>(kLongestGapNs)));
}

/// Moves `from` towards `target` by at most `step`; true if that limit applied.
bool slew(Vec3& from, const Vec3& target, double step) noexcept {
  Vec3 change = target - from;
  const bool cut = clamp_length(change, step);
  from = cut ? Vec3(from + change) : target;
  return cut;
}

}  // namespace

ForceGuard::ForceGuard(const GuardConfig& config)
    : config_((config.validate(), config)),
      period_ns_(std::llround(config.period_s / kSecondsPerNs)),
      hold_ns_(std::llround(config.hold_periods * config.period_s / kSecondsPerNs)) {}

Wrench ForceGuard::pass(const std::optional<GuardInput>& command, std::int64_t now_ns) noexcept {
  const std::int64_t dt_ns = elapsed_ns(now_ns);
  if (phase_ == Phase::kStopped)
    return {};
  const bool faded_out = update_phase(dt_ns, now_ns);
  if (command)
    accept(*command, now_ns);
  // This period's slew was used to reach zero; a new command starts there in the next period.
  if (faded_out)
    return output_;
  update_output(static_cast<double>(std::min(dt_ns, hold_ns_)) * kSecondsPerNs);
  return output_;
}

std::int64_t ForceGuard::elapsed_ns(std::int64_t now_ns) noexcept {
  const std::optional<std::int64_t> last = std::exchange(last_ns_, now_ns);
  if (!last)
    return period_ns_;
  if (now_ns <= *last) {
    ++counts_.clock_faults;
    return period_ns_;
  }
  return gap_ns(*last, now_ns);
}

bool ForceGuard::update_phase(std::int64_t dt_ns, std::int64_t now_ns) noexcept {
  if (phase_ == Phase::kIdle)
    return false;
  age_ns_ = std::min(age_ns_ + dt_ns, kLongestGapNs);
  std::int64_t over_ns = age_ns_ - hold_ns_;
  if (now_ns > valid_until_ns_)
    over_ns = std::max(over_ns, gap_ns(valid_until_ns_, now_ns));
  if (phase_ == Phase::kLive && over_ns > 0) {
    phase_ = Phase::kFading;
    fade_from_ = output_;
    fade_ = 1.0;
    ++counts_.faded;
  }
  if (phase_ == Phase::kLive) {
    advance_ramp(static_cast<double>(dt_ns) *
                 kSecondsPerNs);  // at most the hold: a longer gap begins a fade
    return false;
  }
  fade_ = std::min(fade_, 1.0 - static_cast<double>(over_ns) * kSecondsPerNs / config_.fade_s);
  if (fade_ > 0.0)
    return false;
  phase_ = Phase::kIdle;
  output_ = {};
  fraction_ = 0.0;
  return true;
}

void ForceGuard::advance_ramp(double dt_s) noexcept {
  const double ramp_s = ramped_once_ ? config_.return_ramp_s : config_.start_ramp_s;
  fraction_ = ramp_s > 0.0 ? std::min(1.0, fraction_ + dt_s / ramp_s) : 1.0;
  if (fraction_ >= 1.0)
    ramped_once_ = true;
}

void ForceGuard::accept(const GuardInput& command, std::int64_t now_ns) noexcept {
  if (!command.wrench.finite()) {
    ++counts_.refused_not_finite;
    return;
  }
  if (command.valid_until_ns < now_ns) {
    ++counts_.refused_stale;
    return;
  }
  ++counts_.passed;
  command_ = command.wrench;
  const WrenchCut cut = clamp_wrench(command_, config_.max_force_n, config_.max_torque_nm);
  counts_.clamped_force += cut.force, counts_.clamped_torque += cut.torque;
  age_ns_ = 0;
  valid_until_ns_ = command.valid_until_ns;
  if (phase_ == Phase::kFading)
    fraction_ *= fade_;
  if (phase_ == Phase::kIdle)
    fraction_ = 0.0, advance_ramp(0.0);
  phase_ = Phase::kLive;
}

void ForceGuard::update_output(double dt_s) noexcept {
  if (phase_ == Phase::kIdle)
    return;
  if (phase_ == Phase::kFading) {
    // No steeper than limit / fade_s, which `validate` requires to be within the slew limit.
    output_ = {fade_from_.force * fade_, fade_from_.torque * fade_};
  } else {
    const double force_step = config_.max_force_rate_n_per_s * dt_s;
    const double torque_step = config_.max_torque_rate_nm_per_s * dt_s;
    const bool force_cut = slew(output_.force, command_.force * fraction_, force_step);
    const bool torque_cut = slew(output_.torque, command_.torque * fraction_, torque_step);
    if (force_cut || torque_cut)
      ++counts_.clamped_slew;
  }
  // Against rounding: both ends of a slew are within the limits, so all between them is too.
  clamp_wrench(output_, config_.max_force_n, config_.max_torque_nm);
}

void ForceGuard::count(GateVerdict verdict) noexcept {
  switch (verdict) {
    case GateVerdict::kAccepted:
      return;
    case GateVerdict::kForeignWriter:
      ++counts_.refused_writer;
      return;
    case GateVerdict::kForeignSession:
      ++counts_.refused_session;
      return;
    case GateVerdict::kOldSequence:
    case GateVerdict::kFutureSequence:
      ++counts_.refused_sequence;
      return;
  }
}

void ForceGuard::stop() noexcept {
  restart();
  phase_ = Phase::kStopped;
}

void ForceGuard::restart() noexcept {
  phase_ = Phase::kIdle;
  last_ns_.reset();
  command_ = output_ = fade_from_ = {};
  fraction_ = fade_ = 0.0;
  age_ns_ = 0;
  ramped_once_ = false;
}

double ForceGuard::fraction() const noexcept {
  return phase_ == Phase::kFading ? fraction_ * fade_ : phase_ == Phase::kLive ? fraction_ : 0.0;
}

GuardConfig guard_config(const DeviceDescription& device) noexcept {
  GuardConfig config;
  config.period_s = 1.0 / device.rate_hz;
  config.max_force_n = device.max_force_n;
  config.max_torque_nm = device.max_torque_nm;
  config.max_force_rate_n_per_s = device.max_force_rate_n_per_s;
  config.max_torque_rate_nm_per_s = device.max_torque_rate_nm_per_s;
  return config;
}

void GuardConfig::validate() const {
  const auto require = [](bool good, std::string_view field, double value, std::string_view rule) {
    if (!good)
      throw std::runtime_error(
          fmt::format("force guard: {} is {}; it must be {}", field, value, rule));
  };
  const auto in = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  constexpr double kMaxLimit = 1e9;  // above the force of any device
  require(in(period_s, 1e-6, 1.0), "period_s", period_s, "in [1e-6, 1] s");
  require(max_force_n > 0.0 && max_force_n <= kMaxLimit, "max_force_n", max_force_n,
          "> 0 and finite");
  require(in(max_torque_nm, 0.0, kMaxLimit), "max_torque_nm", max_torque_nm,
          ">= 0 (0: no torque) and finite");
  require(in(hold_periods, 1.0, 1000.0), "hold_periods", hold_periods, "in [1, 1000]");
  require(fade_s > 0.0 && fade_s <= 1.0, "fade_s", fade_s, "in (0, 1] s");
  require(in(start_ramp_s, 0.0, 10.0), "start_ramp_s", start_ramp_s, "in [0, 10] s");
  require(in(return_ramp_s, 0.0, 10.0), "return_ramp_s", return_ramp_s, "in [0, 10] s");
  const double force_fade = max_force_n / fade_s, torque_fade = max_torque_nm / fade_s;
  require(max_force_rate_n_per_s >= force_fade, "max_force_rate_n_per_s", max_force_rate_n_per_s,
          fmt::format("at least max_force_n / fade_s = {}", force_fade));
  require(max_torque_rate_nm_per_s >= torque_fade, "max_torque_rate_nm_per_s",
          max_torque_rate_nm_per_s,
          fmt::format("at least max_torque_nm / fade_s = {}", torque_fade));
}

}  // namespace voxtouch::devices
