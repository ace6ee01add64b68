#include "core/coupling/design/limit_cycle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/sampled_plant.hpp"
#include "core/coupling/pt2.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;
constexpr int kSpan = 4096;  ///< samples per span
constexpr int kMaxSpans = 6;
constexpr double kRest = 1e-6;  ///< the sum ends at a span that adds less than this fraction

/// The law and the injected damping, sample by sample.
class Steps {
 public:
  Steps(const LoopController& law, double contact_stiffness, double period_s)
      : law_(law),
        k_(contact_stiffness),
        period_(period_s),
        filter_(Pt2Coefficients::of(law.w0_rad_per_s, law.damping_ratio, period_s)),
        fresh_(law.velocity_filter_rad_per_s > 0.0
                   ? 1.0 - std::exp(-law.velocity_filter_rad_per_s * period_s)
                   : 1.0) {}

  double effort(double position) {
    const double difference = (position - last_) / period_;
    last_ = position;
    if (law_.velocity_window > 0) {
      std::shift_right(differences_.begin(), differences_.end(), 1);
      differences_[0] = difference, velocity_ = 0.0;
      for (int ago = 0; ago < window_span(law_.velocity_window); ++ago)
        velocity_ += window_weight(law_.velocity_window, ago) * differences_[ago];
    } else {
      velocity_ += fresh_ * (difference - velocity_);
    }
    return law(position) + law_.injected_damping * velocity_;
  }

 private:
  double law(double position) {
    if (law_.law == Law::kShapingFilter)
      return state_.advance(filter_, 1.0, k_ * position);
    if (law_.law == Law::kDirect)
      return k_ * position;
    const double damper = law_.damping / period_;
    object_ = (k_ * position + damper * object_) / (k_ + law_.stiffness + damper);
    return k_ * (position - object_);
  }

  const LoopController& law_;
  double k_, period_;
  Pt2Coefficients filter_;
  Pt2State state_;
  double fresh_, velocity_ = 0.0, last_ = 0.0, object_ = 0.0;
  std::array<double, window_span(kMaxVelocityWindow)> differences_{};
};

}  // namespace

double pulse_gain(const LoopPlant& p, const LoopController& law, double contact_stiffness,
                  double position_error, double effort) {
  const SampledPlant plant = sample_plant(p);
  Steps steps(law, contact_stiffness, p.period_s);
  const std::size_t places = static_cast<std::size_t>(plant.whole_delay) + 2;
  std::vector<double> commands(places, 0.0);  // ring buffer of the last commands
  Eigen::Vector3d state = Eigen::Vector3d::Zero();
  double sum = 0.0, before = 0.0;
  std::size_t now = 0;
  for (int span = 0; span < kMaxSpans; ++span) {
    double part = 0.0;
    for (int i = 0; i < kSpan; ++i) {
      commands[now] = -plant.effort_unit * (steps.effort(state[0] + position_error) + effort);
      position_error = effort = 0.0;
      const double newer =
          commands[(now + places - static_cast<std::size_t>(plant.whole_delay)) % places];
      const double older = commands[(now + 1) % places];
      state += plant.step_less_one * state + plant.newer * newer + plant.older * older;
      now = (now + 1) % places;
      part += std::abs(state[0]);
    }
    sum += part;
    if (part <= kRest * sum)
      return sum;
    // The remainder decays from span to span by the same ratio.
    if (span + 1 == kMaxSpans && part < before)
      return sum + part * part / (before - part);
    before = part;
  }
  return sum;
}

double limit_cycle_bound(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness, double displayed_stiffness,
                         double velocity_band) {
  const double q = problem.model.resolution;
  if (q == 0.0 || displayed_stiffness == 0.0)
    return 0.0;
  const double shape = law.law == Law::kShapingFilter ? law.damping_ratio : 1.0;
  const double passed =
      step_ratio(law.velocity_filter_rad_per_s, law.velocity_window, problem.timing.period_s);
  const double of_band = law.injected_damping * velocity_band;
  const double needed = limit_cycle_friction(shape, displayed_stiffness, q) +
                        law.injected_damping * q / problem.timing.period_s * passed + of_band;
  if (problem.model.coulomb_friction >= needed)
    return 0.0;
  double worst = 0.0;
  for (const DesignCase& one : problem.cases)
    worst = std::max(
        worst,
        q * pulse_gain(one.plant, law, contact_stiffness, 1.0, 0.0) +
            (of_band > 0.0 ? 2.0 * of_band * pulse_gain(one.plant, law, contact_stiffness, 0.0, 1.0)
                           : 0.0));
  return worst;
}

}  // namespace voxtouch::coupling::design
