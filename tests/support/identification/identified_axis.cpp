#include "tests/support/identification/identified_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace voxtouch::testing {

IdentifiedAxis::IdentifiedAxis(const AxisTruth& truth, std::uint64_t seed)
    : truth_(truth),
      random_(seed) {
  offset_ = truth.encoder_step_m * uniform();
}

double IdentifiedAxis::friction(double velocity, double dx) {
  if (truth_.coulomb_n <= 0.0)
    return 0.0;
  bristle_ = std::clamp(bristle_ + dx / truth_.presliding_m, -1.0, 1.0);
  const double ratio = velocity / truth_.stribeck_speed;
  return truth_.coulomb_n * (1.0 + truth_.stribeck * std::exp(-ratio * ratio)) * bristle_;
}

double IdentifiedAxis::hand_force() const {
  const double w = 2.0 * std::numbers::pi * hand_.frequency_hz;
  const double angle = w * time_ + hand_.phase;
  const double target = hand_.amplitude_m * (std::sin(angle) - std::sin(hand_.phase));
  const double speed = hand_.amplitude_m * w * std::cos(angle);
  return hand_.stiffness_n_per_m * (target - x_[0]) + hand_.damping_ns_per_m * (speed - v_[0]) +
         hand_.tremor_n * std::sin(2.0 * std::numbers::pi * hand_.tremor_hz * time_);
}

void IdentifiedAxis::move(double until) {
  const double m = truth_.mass_kg + hand_.mass_kg;
  const double steady = truth_.mode_hz > 0.0 ? 25e-6 : 50e-6;
  const double contact =
      0.1 * std::sqrt(m * truth_.presliding_m / std::max(1e-9, 1.5 * truth_.coulomb_n));
  const double longest = std::min(steady, std::max(2e-6, contact));
  const double far = truth_.mode_hz > 0.0 ? truth_.mode_mass_ratio * m : 0.0, near = m - far;
  const double omega = 2.0 * std::numbers::pi * truth_.mode_hz;
  const double reduced = far > 0.0 ? near * far / m : 0.0;
  const double k = reduced * omega * omega, d = 2.0 * truth_.mode_damping * omega * reduced;
  while (time_ < until - 1e-12) {
    double end = std::min(until, time_ + longest);
    while (!arrivals_.empty() && arrivals_.front().time_s <= time_ + 1e-12) {
      applied_ = arrivals_.front().force_n;
      arrivals_.pop_front();
    }
    if (!arrivals_.empty())
      end = std::min(end, arrivals_.front().time_s);
    const double h = end - time_;
    double force = applied_;
    if (truth_.lag_s > 0.0) {
      lagged_ += (applied_ - lagged_) * (-std::expm1(-h / truth_.lag_s));
      force = lagged_;
    }
    double push = force;
    if (time_ >= fault_s_) {
      if (fault_ == AxisFault::kWrongSign)
        push = -force;
      if (fault_ == AxisFault::kForceTenfold)
        push = 10.0 * force;
      if (fault_ == AxisFault::kRunaway)
        push = force + 0.5 * truth_.max_force_n;
    }
    const double coupling = far > 0.0 ? k * (x_[1] - x_[0]) + d * (v_[1] - v_[0]) : 0.0;
    const double before = v_[0];
    const double total =
        push + truth_.bias_n - friction(v_[0], v_[0] * h) + coupling + hand_force();
    const double half = 0.5 * h * truth_.viscous_ns_per_m / near;
    v_[0] = (v_[0] * (1.0 - half) + h * total / near) / (1.0 + half);
    if (time_ >= fault_s_ && fault_ == AxisFault::kStuck)
      v_[0] = 0.0;
    const double dx = 0.5 * h * (before + v_[0]);
    x_[0] += dx;
    energy_ += std::max(0.0, push * dx);
    if (far > 0.0) {
      const double old = v_[1];
      v_[1] -= h * coupling / far;
      x_[1] += 0.5 * h * (old + v_[1]);
    }
    time_ = end;
  }
}

AxisSample IdentifiedAxis::next() {
  const double period = 1.0 / truth_.rate_hz;
  do {
    move(time_ + period * (1.0 + truth_.jitter * (2.0 * uniform() - 1.0)));
  } while (uniform() < truth_.loss);
  const double x = truth_.encoder_at_far_mass && truth_.mode_hz > 0.0 ? x_[1] : x_[0];
  const double q = truth_.encoder_step_m;
  AxisSample out{time_, q * std::floor((x + offset_) / q)};
  if (time_ < fault_s_)
    return out;
  if (fault_ == AxisFault::kEncoderFrozen) {
    if (!frozen_)
      frozen_ = out.position_m;
    out.position_m = *frozen_;
  }
  if (fault_ == AxisFault::kEncoderScale)
    out.position_m *= 0.1;
  if (fault_ == AxisFault::kClockStops) {
    if (frozen_time_ == 0.0)
      frozen_time_ = out.time_s;
    out.time_s = frozen_time_;
  }
  if (fault_ == AxisFault::kNotFinite)
    out.position_m = std::numeric_limits<double>::quiet_NaN();
  return out;
}

void IdentifiedAxis::command(double force_n) {
  const double force = std::clamp(force_n, -truth_.max_force_n, truth_.max_force_n);
  if (uniform() < truth_.loss)
    return;
  arrivals_.push_back({time_ + truth_.delay_s, force});
}

}  // namespace voxtouch::testing
