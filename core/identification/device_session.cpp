#include "core/identification/device_session.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::identification {
namespace {

constexpr double kGuessedMassRatio = 0.5;
constexpr double kReturnSpeed = 0.02;  // [m/s] of a measured axis back to its start

}  // namespace

void DeviceSession::start(const SessionOptions& options) {
  options_ = options;
  for (std::size_t a = 0; a < 3; ++a) {
    if (options.axes[a])
      excitation_[a].start(options.limits);
    spring_[a].start();
    figures_[a] = {};
  }
  first_ = true;
  outcome_ = Outcome::kMeasured;
  axis_ = 3;
  for (std::size_t a = 3; a-- > 0;)
    if (options.axes[a])
      axis_ = a;
}

void DeviceSession::next_axis() noexcept {
  if (axis_ < 3) {
    rest_[axis_] = last_[axis_];
    rest_force_n_[axis_] = -excitation_[axis_].model().bias_n;
  }
  do
    ++axis_;
  while (axis_ < 3 && !options_.axes[axis_]);
  if (axis_ < 3)
    excitation_[axis_].take_over(spring_[axis_], rest_force_n_[axis_]);
}

Vec3 DeviceSession::step(double time_s, const Vec3& position) noexcept {
  if (finished())
    return Vec3::Zero();
  if (first_ && position.allFinite() && std::isfinite(time_s)) {
    first_ = false;
    last_time_s_ = time_s;
    for (std::size_t a = 0; a < 3; ++a)
      start_[a] = rest_[a] = position[static_cast<Eigen::Index>(a)];
  }
  double path = 0.0;  // none without a clock
  if (std::isfinite(time_s)) {
    path = std::clamp(time_s - last_time_s_, 0.0, 0.1) * kReturnSpeed;
    last_time_s_ = time_s;
  }
  Vec3 force = Vec3::Zero();
  const double allowed = options_.limits.allowed_force_n;
  for (std::size_t a = 0; a < 3; ++a) {
    last_[a] = position[static_cast<Eigen::Index>(a)];
    const auto i = static_cast<Eigen::Index>(a);
    if (a == axis_) {
      force[i] = excitation_[a].step(time_s, position[i]);
      continue;
    }
    if (!std::isfinite(position[i]) || !std::isfinite(time_s))
      continue;
    rest_[a] += std::clamp(start_[a] - rest_[a], -path, path);
    spring_[a].sample(time_s, position[i], excitation_[axis_].encoder_step_m());
    force[i] = std::clamp(rest_force_n_[a] + spring_[a].force(rest_[a], 0.0), -0.8 * allowed,
                          0.8 * allowed);
    if (std::abs(position[i] - rest_[a]) > options_.limits.box_m)
      excitation_[axis_].stop(Outcome::kLeftBounds);
  }
  AxisExcitation& current = excitation_[axis_];
  if (!current.finished() || !current.outcome())
    return force;
  figures_[axis_].outcome = *current.outcome();
  figures_[axis_].break_away_n = current.break_away_n();
  if (ends_session(*current.outcome())) {
    outcome_ = *current.outcome();
    axis_ = 3;
    return Vec3::Zero();
  }
  next_axis();
  return force;
}

void DeviceSession::applied(const Vec3& force) noexcept {
  if (finished())
    return;
  const std::size_t b = (axis_ + 1) % 3, c = (axis_ + 2) % 3;
  excitation_[axis_].applied(
      force[static_cast<Eigen::Index>(axis_)],
      {.force_n = {force[static_cast<Eigen::Index>(b)], force[static_cast<Eigen::Index>(c)]},
       .position_m = {last_[b] - rest_[b], last_[c] - rest_[c]}});
}

FitResult fit(const FitInput& input) {
  if (input.step != Step::kFitAll)
    return {model_so_far(input), {}};
  FitResult out{input.model, final_figures(input)};
  if (out.figures.outcome == Outcome::kMeasured)
    out.model = out.figures.model();
  return out;
}

void DeviceSession::resume(const FitResult& result) noexcept {
  if (!waiting())
    return;
  AxisExcitation& e = excitation_[axis_];
  const bool last = e.current() == Step::kFitAll;
  e.resume(result.model);
  // The axes at rest move with this one; before they are measured, half its mass is a careful
  // guess.
  for (std::size_t a = 0; a < 3; ++a) {
    if (a == axis_ && !last)
      continue;
    AxisModel model = result.model;
    if (figures_[a].outcome == Outcome::kMeasured)
      model = figures_[a].model();
    else if (a != axis_)
      model.mass_kg *= kGuessedMassRatio;
    spring_[a].follow(model, options_.limits.period_s, e.encoder_step_m(),
                      options_.limits.allowed_force_n);
  }
  if (!last)
    return;
  figures_[axis_] = result.figures;
  next_axis();
}

}  // namespace voxtouch::identification
