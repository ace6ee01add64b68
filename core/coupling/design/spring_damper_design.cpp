#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/loop_table.hpp"

namespace voxtouch::coupling::design {
namespace {

/// r / c in periods.
constexpr std::array kLeads{0.0, 0.25, 0.5, 0.75, 1.0,  1.5,  2.0, 3.0,
                            4.0, 6.0,  8.0, 12.0, 16.0, 24.0, 32.0};
/// Ratios of contact to coupling stiffness at which the table is evaluated; the exact check covers
/// the values between them.
constexpr std::array kContacts{kInfinity, 10.0, 3.0, 1.0, 0.3, 0.1};
constexpr double kShrink = 0.97;
constexpr int kMaxBackoffs = 24;

/// The law of unit stiffness and `lead` of damping, with a contact of `contact` units.
Complex series_at(double lead_s, double contact, const DecayingPhasor& at, double period_s) {
  const Complex own = 1.0 + lead_s / period_s * at.z_less_one * at.z_inverse;
  return std::isinf(contact) ? own : contact * own / (contact + own);
}

bool passive_only(const std::vector<AxisProblem>& problems) {
  return std::ranges::any_of(problems, [](const AxisProblem& a) { return a.hand.any_passive; });
}

/// Effect of one law of translation on the axis, per unit.
double arm_of(const DesignProblem& request, std::size_t axis) {
  return axis == 0 ? 1.0 : arm_squared(request);
}

SpringDamperPair passive_pair(const DesignProblem& request,
                              const std::vector<AxisProblem>& problems) {
  const LoopTiming slow = slowest(request.device.timing);
  double lag = 0.0;
  for (const AxisProblem& axis : problems)
    lag = std::max(lag, effort_lag_s(axis.model));
  const double damping = problems[0].series_ratio * problems[0].model.damping / problems[0].margin;
  SpringDamperPair pair = llewellyn_optimum(damping, slow.period_s, whole_delay(slow, lag));
  const double nominal =
      llewellyn_damping(pair.stiffness, pair.damping, request.device.timing.period_s,
                        whole_delay(request.device.timing, lag));
  const double fraction = nominal > damping ? damping / nominal : 1.0;
  return {fraction * pair.stiffness, fraction * pair.damping};
}

bool holds(const DesignProblem& request, const std::vector<AxisProblem>& problems,
           const SpringDamperPair& pair) {
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const double scale = arm_of(request, a) * problems[a].margin;
    LoopController law;
    law.law = LoopController::Law::kSpringDamper;
    law.stiffness = scale * pair.stiffness, law.damping = scale * pair.damping;
    for (const DesignCase& one : problems[a].cases)
      if (!std::isinf(critical_stiffness(one.plant, law).stiffness))
        return false;
  }
  return true;
}

/// The stiffest pair for the cases, by the table and then verified.
SpringDamperPair ranged_pair(const DesignProblem& request,
                             const std::vector<AxisProblem>& problems) {
  std::vector<LoopTable> tables;
  for (const AxisProblem& axis : problems)
    tables.emplace_back(axis.cases, std::span<const VelocityEstimate>{});
  SpringDamperPair best;
  for (const double lead : kLeads) {
    const double lead_s = lead * request.device.timing.period_s;
    double stiffness = kInfinity;
    for (const double contact : kContacts) {
      if (stiffness <= best.stiffness)
        break;
      for (std::size_t a = 0; a < problems.size(); ++a) {
        const double unit = problems[a].margin * arm_of(request, a);
        tables[a].use([&](const DecayingPhasor& at, double period) {
          return series_at(lead_s, contact, at, period);
        });
        stiffness = std::min(stiffness, tables[a].critical(0, 0.0, unit * best.stiffness) / unit);
        if (stiffness <= best.stiffness)
          break;
      }
    }
    if (stiffness > best.stiffness && std::isfinite(stiffness))
      best = {stiffness, lead_s * stiffness};
  }
  for (int i = 0; i < kMaxBackoffs; ++i) {
    if (best.stiffness <= 0.0 || holds(request, problems, best))
      return best;
    best.stiffness *= kShrink, best.damping *= kShrink;
  }
  return {};
}

/// c with which the stiffest contact displays the device's limit c k / (c + k).
double most_stiffness(const DesignProblem& request, const std::vector<AxisProblem>& problems) {
  double most = kInfinity;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const double k = problems[a].contact.all_points, limit = problems[a].model.max_stiffness;
    if (k > limit)
      most = std::min(most, limit * k / (k - limit) / arm_of(request, a));
  }
  return most;
}

}  // namespace

Proposal propose_spring_damper(const DesignProblem& request,
                               const std::vector<AxisProblem>& problems) {
  SpringDamperPair pair = passive_pair(request, problems);
  if (!passive_only(problems)) {
    const SpringDamperPair ranged = ranged_pair(request, problems);
    if (ranged.stiffness > pair.stiffness)
      pair = ranged;
  }
  const double most = most_stiffness(request, problems);
  if (pair.stiffness > most)
    pair = {most, pair.damping * most / pair.stiffness};
  Proposal out;
  out.spec.kind = "spring_damper";
  out.spec.stiffness_n_per_m = pair.stiffness;
  out.spec.damping_ns_per_m = pair.damping;
  bool met = true;
  for (std::size_t a = 0; a < problems.size(); ++a) {
    const double c = pair.stiffness * arm_of(request, a), k = problems[a].contact.all_points;
    met = met && c * k / (c + k) >= kSeriesRatio * problems[a].target;
  }
  out.status = met ? DesignStatus::kAsRequested : DesignStatus::kStiffnessReduced;
  return out;
}

}  // namespace voxtouch::coupling::design
