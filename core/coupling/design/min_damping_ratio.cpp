#include "core/coupling/design/min_damping_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/coupling/design/filter_search.hpp"

namespace voxtouch::coupling::design {
namespace {

constexpr int kHalvings = 12;
/// Fractions of the largest injected damping at which a case may oscillate least: more damping also
/// acts later.
constexpr std::array kDampingFractions{1.0, 0.5, 0.25};

double ratio(const LoopPlant& plant, const LoopController& law, double contact) {
  try {
    return slowest_damping_ratio(plant, law, contact);
  } catch (const std::runtime_error&) {
    return 0.0;  // eigenvalues that do not converge give no damping
  }
}

/// The law at a fraction of its displayed stiffness, and the contact in series with it.
struct Loop {
  LoopController law;
  double contact;
};
Loop loop_of(const DesignProblem& request, const AxisProblem& problem, const CouplingSpec& spec,
             const DisplayedStiffness& displayed, double fraction) {
  LoopController law = controller_of(spec, problem, arm_squared(request));
  if (law.law != LoopController::Law::kSpringDamper)
    return {law, fraction * displayed.displayed};
  law.stiffness *= fraction, law.damping *= fraction;
  return {law, displayed.contact};
}

/// The best damping ratio of the case in the softest useful contact, over the tried injected
/// dampings.
double best_ratio(const AxisProblem& problem, const DesignCase& one, bool may_damp, bool windows) {
  const double contact = std::min(problem.useful, problem.target);
  LoopController law;
  law.law = LoopController::Law::kDirect;
  double best = ratio(one.plant, law, contact);
  for (const VelocityEstimate& velocity : velocity_estimates(may_bounce(problem), windows))
    for (const double fraction : kDampingFractions) {
      if (!may_damp || best >= one.least_damping_ratio)
        return best;
      law.use(velocity);
      law.injected_damping = fraction * damping_limit(problem, velocity);
      best = std::max(best, ratio(one.plant, law, contact));
    }
  return best;
}

/// The largest x <= 1 for which `keeps` holds, by bisection as if it were monotone; 0 if it fails
/// even for the smallest tried x.
double largest(const std::function<bool(double)>& keeps) {
  if (keeps(1.0))
    return 1.0;
  double low = 0.0, high = 1.0;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (low + high);
    (keeps(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

DominantMode dominant_mode(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                           const CouplingSpec& spec) {
  const std::vector<DisplayedStiffness> displayed = displayed_stiffness(request, problems, spec);
  DominantMode out;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const Loop loop = loop_of(request, problems[a], spec, displayed[a], 1.0);
    for (const DesignCase& one : problems[a].cases) {
      LeastDamping& least = one.gripped ? out.gripped : out.released;
      if (const double here = ratio(one.plant, loop.law, loop.contact); here < least.ratio)
        least = {here, a, one};
    }
  }
  return out;
}

LeastDamping set_min_damping(const DesignProblem& request, std::vector<AxisProblem>& problems) {
  const bool may_damp =
      request.goals.allow_injected_damping && request.goals.kind != "spring_damper";
  LeastDamping out_of_reach;
  const auto set = [&](AxisProblem& problem, bool gripped, double minimum) {
    bool forbidden = false;
    for (DesignCase& one : problem.cases) {
      if (one.gripped != gripped)
        continue;
      one.least_damping_ratio = minimum;
      if (minimum <= 0.0)
        continue;
      const double best = best_ratio(problem, one, may_damp, request.goals.velocity_windows);
      if (best >= minimum)
        continue;
      forbidden = true;
      if (best < out_of_reach.ratio)
        out_of_reach = {best, problem.axis, one};
    }
    for (DesignCase& one : problem.cases)
      if (forbidden && one.gripped == gripped)
        one.least_damping_ratio = 0.0;
  };
  for (std::size_t a = 0; a < problems.size(); ++a) {
    if (problems[a].hand.any_passive)
      continue;
    const MinDampingRatios& min_damping =
        a == 0 ? request.goals.min_damping : request.goals.rotation_min_damping;
    set(problems[a], false, min_damping.released);
    set(problems[a], true, min_damping.gripped);
  }
  return out_of_reach;
}

bool meets_min_damping(const AxisProblem& problem, const LoopController& law, double contact) {
  std::size_t first = 0;
  return meets_min_damping(problem, law, contact, first);
}

bool meets_min_damping(const AxisProblem& problem, const LoopController& law, double contact,
                       std::size_t& first) {
  const auto keeps = [&](const DesignCase& one) {
    return one.least_damping_ratio <= 0.0 ||
           ratio(one.plant, law, contact) >= one.least_damping_ratio;
  };
  if (!keeps(problem.cases[first]))
    return false;
  for (std::size_t i = 0; i < problem.cases.size(); ++i)
    if (i != first && !keeps(problem.cases[i]))
      return first = i, false;
  return true;
}

bool meets_min_damping(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                       const CouplingSpec& spec, double fraction) {
  const std::vector<DisplayedStiffness> displayed = displayed_stiffness(request, problems, spec);
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const Loop loop = loop_of(request, problems[a], spec, displayed[a], fraction);
    if (!meets_min_damping(problems[a], loop.law, loop.contact))
      return false;
  }
  return true;
}

double damped_stiffness(const AxisProblem& problem, const LoopController& law, double most) {
  std::size_t first = 0;
  return most * largest([&](double fraction) {
           return meets_min_damping(problem, law, fraction * most, first);
         });
}

double damped_fraction(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                       const CouplingSpec& spec) {
  return largest(
      [&](double fraction) { return meets_min_damping(request, problems, spec, fraction); });
}

}  // namespace voxtouch::coupling::design
