#include "core/coupling/swing_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace voxtouch::coupling {
namespace {

double least_force_n(const SwingDevice& device, double part) noexcept {
  const bool known = device.max_force_n > 0.0 && std::isfinite(device.max_force_n);
  return known ? std::max(part * device.max_force_n, SwingWatch::kLeastN) : SwingWatch::kLeastN;
}

}  // namespace

void SwingWatch::clear() noexcept {
  now_ = last_ = {};
  position_m_ = outermost_m_ = 0.0;
  outward_ = swinging_ = false;
  alike_ = 0;
  if (!growing())
    grown_ = 0;
}

void SwingWatch::begin_cycle(double force_n) noexcept {
  now_ = {};
  now_.low_m = now_.high_m = position_m_;
  now_.low_n = now_.high_n = force_n;
}

bool SwingWatch::tremor_like(const Cycle& cycle) noexcept {
  return cycle.period_s > kFastTremorS && cycle.period_s < kTremorS &&
         cycle.amplitude_m() < kTremorM;
}

bool SwingWatch::large_enough(const Cycle& cycle) const noexcept {
  const double steps = cycle.period_s > kVoluntaryS || tremor_like(cycle) ? kSlowSteps : kSteps;
  return cycle.amplitude_m() > steps * device_.resolution_m &&
         cycle.force_n() > least_force_n(device_, 0.005) &&
         cycle.shift.norm() <= kClosed * cycle.amplitude_m();
}

/// Whether the operator has put in no energy, within the resolution of the encoder.
bool SwingWatch::without_hand(const Cycle& cycle) const noexcept {
  const double exchanged = 0.25 * std::numbers::pi * cycle.amplitude_m() * cycle.force_n();
  if (cycle.period_s > kVoluntaryS)
    return cycle.hand_j() < -kReceivedRatio * exchanged;
  const double hidden = kHidden * device_.resolution_m * cycle.force_n();
  if (tremor_like(cycle) && cycle.hand_j() > -kDampedRatio * exchanged &&
      cycle.hand_j() < -kHandWorks * exchanged - hidden)
    return false;
  return cycle.hand_j() < kHandWorks * exchanged - hidden;
}

/// Mean force of the device over the last period.
Vec3 SwingWatch::force_at_device(const Vec3& command, double dt_s) noexcept {
  const std::size_t size = commands_.size();
  newest_ = (newest_ + 1) % size;
  commands_[newest_] = command;
  const double late = std::clamp(device_.delay_s / dt_s, 0.0, static_cast<double>(size - 2));
  const auto whole = static_cast<std::size_t>(late);
  const double part = late - static_cast<double>(whole);
  const Vec3& after = commands_[(newest_ + size - whole) % size];
  const Vec3 delayed = after + part * (commands_[(newest_ + size - whole - 1) % size] - after);
  if (!(device_.force_lag_s > 0.0))
    return delayed;
  const double part_reached = -std::expm1(-dt_s / device_.force_lag_s);
  const Vec3 missing = delayed - lagged_;
  lagged_ += part_reached * missing;
  return delayed - part_reached * device_.force_lag_s / dt_s * missing;
}

void SwingWatch::observe(const ToolStep& step, const Vec3& command, const Vec3& normal, double dt_s,
                         double supplied_j) noexcept {
  if (!step.known || normal.isZero(0.0) || !command.allFinite())
    return clear();
  axis_ = axis_.dot(normal) < 0.0 ? Vec3(-normal) : normal;
  const Vec3 given = force_at_device(command, dt_s);
  const double force = command.dot(axis_), length2 = step.translation.squaredNorm();
  position_m_ += step.translation.dot(axis_);
  now_.period_s += dt_s, ++now_.samples;
  now_.low_m = std::min(now_.low_m, position_m_), now_.high_m = std::max(now_.high_m, position_m_);
  now_.low_n = std::min(now_.low_n, force), now_.high_n = std::max(now_.high_n, force);
  now_.force_sum += given, now_.shift += step.translation;
  now_.taken_j += supplied_j;
  rested_sum_ += given, ++rested_, rested_s_ += dt_s;
  if (length2 > 0.0) {
    now_.taken_j += device_.damping_ns_per_m * length2 / rested_s_ +
                    device_.coulomb_friction_n * std::sqrt(length2);
    now_.worked_j += rested_sum_.dot(step.translation) / rested_;
    rested_sum_.setZero(), rested_ = 0, rested_s_ = 0.0;
  }
  if (now_.period_s > 2.0 * kSlowestS) {
    clear();
    return begin_cycle(force);
  }
  // A reversal counts once the tool has returned by more than encoder noise at rest.
  const double back = 1.5 * device_.resolution_m;
  outermost_m_ =
      outward_ ? std::max(outermost_m_, position_m_) : std::min(outermost_m_, position_m_);
  const double returned = outward_ ? outermost_m_ - position_m_ : position_m_ - outermost_m_;
  if (!(returned > back))
    return;
  outward_ = !outward_;
  outermost_m_ = position_m_;
  if (outward_)
    return;  // a cycle lasts from one outermost point to the next
  end_cycle();
  begin_cycle(force);
}

void SwingWatch::watch_growth(bool by_itself, bool like) noexcept {
  if (growing())
    return;
  const bool grew = by_itself && like && last_.force_n() > 0.0 &&
                    now_.force_n() > kGrowth * last_.force_n() &&
                    now_.amplitude_m() > last_.amplitude_m();
  grown_ = grew ? grown_ + 1 : 0;
  // A growing swing this small may continue for a while.
  if (growing() && now_.force_n() < least_force_n(device_, kGrowingForce))
    grown_ = kGrowingCycles - 1;
}

void SwingWatch::end_cycle() noexcept {
  const bool by_itself = large_enough(now_) && now_.period_s <= kSlowestS &&
                         now_.samples >= kFastestSamples && without_hand(now_);
  const bool like = std::abs(now_.period_s - last_.period_s) <= kAlike * last_.period_s;
  watch_growth(by_itself, like);
  const double least_m = std::max(kNoSmaller, 1.0 - kSmallerACycle * alike_) * first_m_;
  if (!by_itself || !like || now_.amplitude_m() < least_m) {  // a different swing, or a decaying
                                                              // one
    alike_ = 0, alike_s_ = 0.0;
    first_m_ = now_.amplitude_m();
    swinging_ = false;
  }
  last_ = now_;
  if (!by_itself)
    return;
  ++alike_, alike_s_ += now_.period_s;
  const bool before = std::exchange(
      swinging_, alike_ >= kCycles || (alike_ >= kGrowingCycles && alike_s_ >= kSwingS));
  if (!swinging_)
    return;
  largest_.swings += before ? 0 : 1;
  largest_.duration_s += before ? now_.period_s : alike_s_;
  if (now_.amplitude_m() < largest_.amplitude_m)
    return;
  largest_.frequency_hz = 1.0 / now_.period_s;
  largest_.amplitude_m = now_.amplitude_m(), largest_.force_n = now_.force_n();
}

}  // namespace voxtouch::coupling
