#include "core/coupling/design/damping_floor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/design_steps.hpp"

namespace voxtouch::coupling::design {
namespace {

constexpr double kSoftShare = 0.01;  ///< of the stiffness, at which a swing is the hand's own
constexpr int kHalvings = 12;

/// One case of one axis with what the coupling does there.
struct Swing {
  const AxisProblem* axis;
  const DesignCase* one;
  LoopController law;
  double contact;  ///< stiffness that the law is given

  double ratio(double share) const {
    LoopController softer = law;
    const bool series = law.law == LoopController::Law::kSpringDamper;
    if (series) softer.stiffness *= share, softer.damping *= share;
    try {
      return slowest_damping_ratio(one->plant, softer, share * contact);
    } catch (const std::runtime_error&) {
      return 0.0;  // eigenvalues that do not converge tell of no damping
    }
  }
  std::string where() const { return fmt::format("{}: {}", axis->units->name, describe(*one, *axis->units)); }
};

std::vector<Swing> swings_of(const DesignProblem& request, const std::vector<AxisProblem>& problems, const CouplingSpec& spec) {
  const std::vector<ShownStiffness> shown = shown_stiffness(request, problems, spec);
  std::vector<Swing> out;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const LoopController law = controller_of(spec, problems[a], arm_squared(request));
    const double contact = law.law == LoopController::Law::kSpringDamper ? shown[a].contact : shown[a].shown;
    for (const DesignCase& one : problems[a].cases) out.push_back({&problems[a], &one, law, contact});
  }
  return out;
}

}  // namespace

SlowestSwing slowest_swing(const DesignProblem& request, const CouplingSpec& spec) {
  refuse_impossible(request);
  const std::vector<AxisProblem> problems = axis_problems(request);
  SlowestSwing out;
  for (const Swing& swing : swings_of(request, problems, spec)) {
    const double ratio = swing.ratio(1.0);
    double& least = swing.one->held ? out.held : out.released;
    if (ratio >= least) continue;
    least = ratio;
    (swing.one->held ? out.held_where : out.released_where) = swing.where();
  }
  return out;
}

DampedDesign with_floors(const DesignProblem& request, const Design& design, const DampingFloors& floors) {
  refuse_impossible(request);
  const std::vector<AxisProblem> problems = axis_problems(request);
  const auto floor_of = [&](const Swing& swing) { return swing.one->held ? floors.held : floors.released; };
  DampedDesign out{design, 0.0, {}};
  std::vector<Swing> binding;
  double worst_alone = 1.0;
  for (const Swing& swing : swings_of(request, problems, design.spec)) {
    const double alone = swing.ratio(kSoftShare);
    if (alone >= floor_of(swing)) {
      binding.push_back(swing);
    } else if (alone < worst_alone) {
      worst_alone = alone;
      out.out_of_reach = fmt::format("{} swings with a damping ratio of {:.2g} by itself", swing.where(), alone);
    }
  }
  std::size_t first = 0;  // that failed last: it fails again most likely
  const auto keeps = [&](double share) {
    for (std::size_t n = 0; n < binding.size(); ++n) {
      const std::size_t at = (first + n) % binding.size();
      if (binding[at].ratio(share) < floor_of(binding[at])) return first = at, false;
    }
    return true;
  };
  if (keeps(1.0)) return out;
  double least = 0.0;
  for (std::size_t a = 0; a < problems.size(); ++a)
    least = std::max(least, std::min(1.0, problems[a].useful / std::max(axis_of(design, a).shown_stiffness, 1e-300)));
  double low = least, high = 1.0;
  if (!keeps(low)) return out;
  for (int n = 0; n < kHalvings; ++n) {
    const double middle = 0.5 * (low + high);
    (keeps(middle) ? low : high) = middle;
  }
  out.design = judge_coupling(request, shrunk(request, design.spec, low));
  out.design.status = design.status == DesignStatus::kInfeasible ? design.status : DesignStatus::kStiffnessReduced;
  out.cost_n_per_m = design.translation.shown_stiffness - out.design.translation.shown_stiffness;
  return out;
}

}  // namespace voxtouch::coupling::design
