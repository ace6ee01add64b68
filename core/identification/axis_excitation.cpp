#include "core/identification/axis_excitation.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::identification {
namespace {

constexpr double kHoldS = 0.8;
constexpr double kRampS = 1.5, kRampRate = 4.0, kRampEndS = 0.3;  // force ~ exp(4 t) - 1
constexpr double kRestS = 0.25, kPulseRestS = 0.08, kLongestPulsesS = 2.5;
constexpr double kMovedM = 50e-6, kMovedSteps = 3.0;
constexpr double kPulseForceRatio = 0.02, kPulseFrictionRatio = 0.08, kPulseForceGrowth = 1.6,
                 kPulseLengthGrowth = 1.5;
constexpr double kPulsePathM = 1e-3, kPulsePathSteps = 12.0, kPulseSpeed = 0.1;
constexpr double kFrictionTried = 0.85;  // of the allowed force
constexpr double kDelayAssumedS = 5e-3;
constexpr double kSlowRatio = 0.4;
constexpr int kProbeStrokes = 4;
constexpr double kStrokesS = 6.0, kDenseS = 5.0;
constexpr double kLongestS = 30.0;      // of the record
constexpr double kFastestPeriod = 0.7;  // of the nominal one, for the capacity

}  // namespace

void AxisExcitation::start(const AxisLimits& limits) {
  AxisRecord record = std::move(record_);
  *this = AxisExcitation();
  record_ = std::move(record);
  record_.reserve(static_cast<std::size_t>(kLongestS / (kFastestPeriod * limits.period_s)));
  limits_ = limits;
  safety_.start(limits);
}

void AxisExcitation::stop(Outcome outcome) noexcept {
  if (!outcome_)
    outcome_ = outcome;
  step_ = Step::kFinished;
}

double AxisExcitation::break_away_n() const noexcept {
  return 0.5 * (std::abs(forward_.force_n) + std::abs(backward_.force_n));
}

FitInput AxisExcitation::fit_input() const noexcept {
  return {.record = &record_,
          .step = step_,
          .model = model_,
          .limits = limits_,
          .pulse = last_pulse_,
          .encoder_step_m = encoder_step_m(),
          .break_away_n = break_away_n()};
}

void AxisExcitation::next(Step step, double time_s) noexcept {
  step_ = step;
  step_start_s_ = time_s;
  start_position_m_ = last_position_m_;
  ++entry_.segment;
  entry_.direction = 0;
}

double AxisExcitation::limited(double force_n) const noexcept {
  double most = limits_.allowed_force_n;
  if (model_.mass_kg > 0.0)
    most = std::min(most, force_that_mass_takes(model_, limits_.period_s));
  return std::clamp(force_n, -most, most);
}

double AxisExcitation::step(double time_s, double position_m) noexcept {
  if (finished())
    return 0.0;
  const bool newer =
      std::isfinite(time_s) && std::isfinite(position_m) && (first_ || time_s > last_time_s_);
  if (const auto broken = safety_.check(time_s, position_m, encoder_step_m())) {
    stop(*broken);
    return 0.0;
  }
  if (!newer)
    return 0.0;
  if (first_) {
    first_ = false;
    last_position_m_ = position_m;
    next(Step::kHold, time_s);
  }
  const double moved = std::abs(position_m - last_position_m_);
  if (!waiting())
    increments_.add(moved);
  last_time_s_ = time_s;
  last_position_m_ = position_m;
  spring_.sample(time_s, position_m, encoder_step_m());
  const double force = limited(dispatch(time_s, position_m));
  if (finished())
    return 0.0;
  if (waiting())
    return force;  // a fit may read the record
  entry_.time_s = time_s;
  entry_.position_m = position_m;
  entry_.force_n = force;
  record_.add(entry_);
  return force;
}

double AxisExcitation::dispatch(double time_s, double position_m) noexcept {
  const double since = time_s - step_start_s_;
  const auto hold = [&](double position) { return spring_.force(position, 0.0) - model_.bias_n; };
  switch (step_) {
    case Step::kHold:
      entry_.part = Part::kHold;
      base_force_n_ = hold(spring_.rest_position_m());
      if (since >= kHoldS) {
        // The force of the spring continues without it, from the present position.
        model_.bias_n = -base_force_n_;
        next(Step::kBreakAwayForward, time_s);
      }
      return base_force_n_;
    case Step::kBreakAwayForward:
      return break_away(time_s, position_m, 1);
    case Step::kRestForward:
      entry_.part = Part::kHold;
      base_force_n_ = hold(start_position_m_);
      if (since >= kRestS)
        next(Step::kBreakAwayBackward, time_s);
      return base_force_n_;
    case Step::kBreakAwayBackward:
      return break_away(time_s, position_m, -1);
    case Step::kRestBackward:
      entry_.part = Part::kHold;
      if (since >= kRestS) {
        finish_break_away();
        if (finished())
          return 0.0;
        pulse_ = {.force_n = std::max(kPulseForceRatio * limits_.allowed_force_n,
                                      kPulseFrictionRatio * model_.coulomb_n),
                  .length_s = std::max(8e-3, 10.0 * limits_.period_s),
                  .end_s = time_s + kLongestPulsesS};
        next(Step::kPulses, time_s);
        pulse_.least_m = pulse_.most_m = position_m;
      }
      return hold(start_position_m_);
    case Step::kPulses:
    case Step::kPulseRest:
      return pulse(time_s, position_m);
    case Step::kProbeStroke:
    case Step::kSecondProbe:
    case Step::kStrokes:
    case Step::kDenseTones:
      return stroke(time_s, position_m);
    case Step::kFitPulses:
    case Step::kFitProbe:
    case Step::kFitSecondProbe:
    case Step::kFitAll:
      entry_.part = Part::kHold;
      return hold(start_position_m_);
    case Step::kFinished:
      break;
  }
  return 0.0;
}

double AxisExcitation::break_away(double time_s, double position_m, int direction) noexcept {
  entry_.part = Part::kBreakAway;
  Ramp& ramp = direction > 0 ? forward_ : backward_;
  const double since = time_s - step_start_s_;
  const double growth =
      std::expm1(kRampRate * std::min(since, kRampS)) / std::expm1(kRampRate * kRampS);
  const double force = std::clamp(base_force_n_ + direction * limits_.allowed_force_n * growth,
                                  -limits_.allowed_force_n, limits_.allowed_force_n);
  // The force keeps growing while the mass starts, so the path is as (t - t_b)^3. The time t_b at
  // which friction broke follows from the times of two paths with the ratio 1.5^3.
  const double enough = std::max(kMovedM, kMovedSteps * encoder_step_m());
  const double path = direction * (position_m - start_position_m_);
  if (ramp.first_s == 0.0 && path >= enough) {
    ramp.first_s = since;
    ramp.first_m = enough;
  }
  const bool moved = ramp.first_s > 0.0 && path >= 3.375 * ramp.first_m;
  ramp.force_n = force;
  ramp.wrong_direction = path <= -enough;
  if (!moved && !ramp.wrong_direction && since < kRampS + (ramp.first_s > 0.0 ? kRampEndS : 0.0))
    return force;
  ramp.moved = ramp.first_s > 0.0;
  if (ramp.moved) {
    const double broke = std::clamp(3.0 * ramp.first_s - 2.0 * since, 0.0, kRampS);
    ramp.force_n = base_force_n_ + direction * limits_.allowed_force_n *
                                       std::expm1(kRampRate * broke) /
                                       std::expm1(kRampRate * kRampS);
  }
  next(direction > 0 ? Step::kRestForward : Step::kRestBackward, time_s);
  return spring_.force(position_m, 0.0) - model_.bias_n;
}

void AxisExcitation::finish_break_away() noexcept {
  if (forward_.wrong_direction && backward_.wrong_direction)
    return stop(Outcome::kWrongDirection);
  if (!forward_.moved && !backward_.moved)
    return stop(forward_.wrong_direction || backward_.wrong_direction ? Outcome::kWrongDirection
                                                                      : Outcome::kDoesNotMove);
  if (forward_.moved && backward_.moved) {
    model_.coulomb_n = std::max(0.0, 0.5 * (forward_.force_n - backward_.force_n));
    model_.bias_n = -0.5 * (forward_.force_n + backward_.force_n);
  } else if (forward_.wrong_direction || backward_.wrong_direction) {
    model_.coulomb_n = std::abs(forward_.moved ? forward_.force_n : backward_.force_n);
  } else {
    return stop(Outcome::kFrictionTooHigh);
  }
  if (model_.coulomb_n + std::abs(model_.bias_n) > kFrictionTried * limits_.allowed_force_n)
    stop(Outcome::kFrictionTooHigh);
}

double AxisExcitation::pulse(double time_s, double position_m) noexcept {
  entry_.part = Part::kPulse;
  const double since = time_s - step_start_s_;
  pulse_.least_m = std::min(pulse_.least_m, position_m);
  pulse_.most_m = std::max(pulse_.most_m, position_m);
  const bool fast = std::abs(spring_.velocity()) > kPulseSpeed;
  if (step_ == Step::kPulseRest) {
    if (since >= kPulseRestS) {
      const double enough = std::max(kPulsePathM, kPulsePathSteps * encoder_step_m());
      const bool done = pulse_.most_m - pulse_.least_m >= enough || time_s > pulse_.end_s || fast;
      last_pulse_.path_m = pulse_.most_m - start_position_m_;
      pulse_.force_n *= kPulseForceGrowth;
      pulse_.length_s *= kPulseLengthGrowth;
      next(done ? Step::kFitPulses : Step::kPulses, time_s);
      pulse_.least_m = pulse_.most_m = position_m;
    }
    return spring_.force(position_m, 0.0) - model_.bias_n;
  }
  if (since >= 4.0 * pulse_.length_s || fast) {
    last_pulse_ = {pulse_.force_n, std::min(since, pulse_.length_s), 0.0};
    step_ = Step::kPulseRest;
    step_start_s_ = time_s;
    return -model_.bias_n;
  }
  const double sign = since < pulse_.length_s || since >= 3.0 * pulse_.length_s ? 1.0 : -1.0;
  return sign * (model_.coulomb_n + pulse_.force_n) - model_.bias_n;
}

void AxisExcitation::resume(const AxisModel& model) noexcept {
  if (!waiting())
    return;
  const Step after = step_ == Step::kFitPulses        ? Step::kProbeStroke
                     : step_ == Step::kFitProbe       ? Step::kSecondProbe
                     : step_ == Step::kFitSecondProbe ? Step::kStrokes
                                                      : Step::kFinished;
  if (after == Step::kFinished) {
    model_ = model;
    step_ = Step::kFinished;
    return;
  }
  model_ = model;
  spring_.follow(model, limits_.period_s, encoder_step_m(), limits_.allowed_force_n);
  next(after, last_time_s_);
  begin_strokes(last_time_s_, last_position_m_);
}

void AxisExcitation::begin_strokes(double time_s, double position_m) noexcept {
  StrokeGoals goals{
      .allowed_force_n =
          0.97 * std::min(limits_.allowed_force_n, force_that_mass_takes(model_, limits_.period_s)),
      .path_m = 1.4 * limits_.box_m,
      .rate_hz = 1.0 / limits_.period_s,
      .encoder_step_m = encoder_step_m()};
  double length = kStrokesS;
  switch (step_) {
    case Step::kProbeStroke:
      goals.path_m *= 0.3;
      goals.longest_s = 0.9;
      entry_.part = Part::kProbeStroke;
      break;
    case Step::kSecondProbe:
      goals.path_m *= 0.6;
      goals.longest_s = 1.0;
      entry_.part = Part::kProbeStroke;
      break;
    case Step::kStrokes:
      entry_.part = Part::kStroke;
      break;
    default:
      entry_.part = Part::kDenseTones;
      goals.lowest_hz = 4.0;
      goals.highest_hz = 220.0;
      goals.tones = 14;
      length = kDenseS;
      break;
  }
  stroke_ = {};
  stroke_.plan = plan_stroke(model_, goals);
  stroke_.until_s = entry_.part == Part::kProbeStroke
                        ? time_s + (kProbeStrokes - 0.5) * stroke_.plan.duration_s
                        : time_s + length - 0.5 * stroke_.plan.duration_s;
  begin_stroke(time_s, position_m);
}

void AxisExcitation::begin_stroke(double time_s, double position_m) noexcept {
  // Two fast strokes, then two slow ones.
  Stroke& s = stroke_;
  const bool slow = s.index % 4 >= 2;
  s.direction = s.index % 2 == 0 ? 1 : -1;
  const double from_origin = position_m - safety_.origin_m();
  const double requested = (slow ? kSlowRatio : 1.0) * s.plan.path_m;
  const auto room = [&] { return 0.7 * limits_.box_m - s.direction * from_origin; };
  if (room() < 0.9 * requested && s.direction * from_origin > 0.0)
    s.direction = -s.direction;
  // fast strokes run from end to end
  const double end = 0.5 * s.plan.path_m - s.direction * from_origin;
  const double length = slow ? requested : std::clamp(end, 0.4 * requested, 1.2 * requested);
  const double path = s.direction * std::clamp(length, 0.0, std::max(0.0, room()));
  s.path_m = path;
  s.tone_scale = std::min(1.0, std::abs(path) / s.plan.path_m);
  s.start_s = time_s;
  s.late_m = position_m;
  ++s.index;
  ++entry_.segment;
  entry_.direction = static_cast<std::int8_t>(s.direction);
  safety_.restart_reference(position_m);
}

double AxisExcitation::stroke(double time_s, double position_m) noexcept {
  Stroke& s = stroke_;
  if (time_s - s.start_s >= s.plan.duration_s) {
    if (time_s >= s.until_s) {
      const Step done = step_;
      next(done == Step::kProbeStroke   ? Step::kFitProbe
           : done == Step::kSecondProbe ? Step::kFitSecondProbe
           : done == Step::kStrokes     ? Step::kDenseTones
                                        : Step::kFitAll,
           time_s);
      if (done != Step::kStrokes)
        return -model_.bias_n;
      begin_strokes(time_s, position_m);
    } else {
      begin_stroke(time_s, position_m);
    }
  }
  const double since = time_s - s.start_s;
  const ReferencePoint now = s.plan.at(since, time_s, s.path_m, s.tone_scale);
  // The measured position lags the force by the delay; compares with the reference of that time.
  const double late_by = model_.delay_s + 0.5 * limits_.period_s;
  const ReferencePoint late = s.plan.at(since - late_by, time_s - late_by, s.path_m, s.tone_scale);
  s.late_m += late.velocity * limits_.period_s;
  if (const auto broken = safety_.check_reference(s.late_m, position_m, encoder_step_m())) {
    stop(*broken);
    return 0.0;
  }
  return model_.mass_kg * now.acceleration + model_.viscous_ns_per_m * now.velocity +
         s.direction * model_.coulomb_n - model_.bias_n + spring_.force(s.late_m, late.velocity);
}

}  // namespace voxtouch::identification
