#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/coupling/design/axis_verdict.hpp"
#include "core/coupling/design/design_steps.hpp"
#include "core/coupling/design/filter_search.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"

namespace voxtouch::coupling::design {
namespace {

// Limits of changes that a laboratory can make: a delay cannot be removed completely, a grip is not
// always firm, and a damper on a handle is at most as strong as the hand that grips it.
constexpr std::array kDelayRatios{0.75, 0.5, 0.25};
constexpr std::array kGripRatios{0.25, 0.5};

/// The goal under a changed circumstance: all axes reach their targets with one of the laws.
struct RemedyCandidate {
  std::vector<std::vector<LoopController>> laws;  ///< [attempt][axis]

  bool holds(const std::vector<AxisProblem>& problems) const {
    return std::ranges::any_of(laws, [&](const std::vector<LoopController>& of_axis) {
      for (std::size_t a = 0; a < problems.size(); ++a)
        if (!(certified_stiffness(problems[a], of_axis[a], problems[a].target) >=
              problems[a].target) ||
            !meets_min_damping(problems[a], of_axis[a], problems[a].target))
          return false;
      return true;
    });
  }
};

/// If stiffness was reduced, the design's own law is tried; if only the cut-off was raised or
/// damping added, the law of the goal.
RemedyCandidate candidate_of(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                             const Design& design, bool short_of) {
  RemedyCandidate candidate;
  if (short_of || design.spec.kind != "shaping_filter") {
    candidate.laws.emplace_back();
    for (const AxisProblem& p : problems) {
      LoopController law = controller_of(design.spec, p, arm_squared(request));
      if (!short_of)
        law.injected_damping = 0.0;
      candidate.laws.back().push_back(law);
    }
    return candidate;
  }
  for (const FilterSetting& shape : filter_settings(request))
    if (shape.cutoff_hz == request.goals.cutoff_hz)
      candidate.laws.emplace_back(problems.size(), law_of(shape));
  return candidate;
}

class Remedies {
 public:
  Remedies(const DesignProblem& request, const std::vector<AxisProblem>& problems,
           const Design& design)
      : request_(request),
        problems_(problems),
        design_(design),
        short_of_(is_short()),
        candidate_(candidate_of(request, problems, design, short_of_)) {
    for (const AxisProblem& problem : problems)
      damped_ = damped_ || std::ranges::any_of(problem.cases, [](const DesignCase& one) {
                  return one.least_damping_ratio > 0.0;
                });
  }

  std::vector<std::string> all() {
    damping();
    injection();
    if (design_.spec.kind !=
        "spring_damper") {  // its certificate differs; its stiffness is its own
      delay();
      rate();
      cap();
      grip();
    }
    if (out_.empty())
      last_resort();
    return std::move(out_);
  }

 private:
  bool is_short() const {
    return design_.status == DesignStatus::kStiffnessReduced ||
           design_.status == DesignStatus::kInfeasible;
  }
  std::string goal() const {
    if (short_of_)
      return "this coupling displays the requested stiffness";
    if (design_.spec.kind == "direct")
      return "no injected damping is needed";
    return fmt::format("{:.3g} Hz needs no injected damping", request_.goals.cutoff_hz);
  }

  /// Used if no single change is sufficient. A softer contact would also be displayed in full, but
  /// is of no use to the operator.
  void last_resort() {
    if (!short_of_ && design_.spec.kind == "shaping_filter")
      out_.push_back(
          fmt::format("A requested cut-off of {:.3g} Hz (now {:.3g}) is met without changes.",
                      design_.spec.cutoff_hz, request_.goals.cutoff_hz));
    else
      out_.push_back(
          "No single change of this device is enough. Use a device with more mass, less delay or "
          "more damping.");
  }

  void damping() {
    for (std::size_t a = 0; a < problems_.size(); ++a) {
      const AxisProblem& p = problems_[a];
      const AxisDesign& d = a == 0 ? design_.translation : design_.rotation;
      if (p.model.damping >= d.damping_required)
        continue;
      const double least =
          std::min(d.damping_required, d.damping_required_any_cutoff) - p.model.damping;
      if (p.hand.any_passive || !(least <= p.hand.damping_max))
        continue;
      if (least <= 0.0) {
        out_.push_back(fmt::format(
            "{}: the request is stable with any passive hand at the highest allowed cut-off.",
            p.units->name));
        continue;
      }
      out_.push_back(
          fmt::format("{}: with a damper of {:.3g} {} at the tool the request is stable with any "
                      "passive hand{}.",
                      p.units->name, least, p.units->damping,
                      d.damping_required_any_cutoff < 0.99 * d.damping_required
                          ? ", at the highest allowed cut-off"
                          : ""));
    }
  }

  void injection() {
    if (request_.goals.allow_injected_damping || design_.spec.kind != "shaping_filter")
      return;
    CandidateCache cache;
    const FilterChoice choice = search_filter(problems_, filter_settings(request_), true,
                                              request_.goals.velocity_windows, cache);
    std::string allowed, displayed;
    bool helps = false;
    for (std::size_t a = 0; a < problems_.size(); ++a) {
      const AxisProblem& p = problems_[a];
      LoopController law = law_of(choice.shape);
      law.injected_damping = choice.damping[a];
      law.use(choice.velocity);
      helps = helps || choice.damping[a] > 0.0;
      allowed +=
          fmt::format("{}{:.3g} {}", a == 0 ? "" : " and ", choice.damping[a], p.units->damping);
      displayed += fmt::format("{}{:.3g} {}", a == 0 ? "" : " and ",
                               std::min(p.target, certified_stiffness(p, law)), p.units->stiffness);
    }
    if (helps)
      out_.push_back(
          fmt::format("With {} of injected damping the hand displays {}.", allowed, displayed));
  }

  void delay() {
    const double now = request_.device.timing.delay_s;
    if (now <= 0.0)
      return;
    for (const double fraction : kDelayRatios) {
      DesignProblem other = request_;
      other.device.timing.delay_s = fraction * now;
      if (!candidate_.holds(same_targets(other)))
        continue;
      out_.push_back(
          fmt::format("With a delay of {:.3g} ms (now {:.3g}), {}. Use a bus without hubs, a "
                      "separate network card or a real-time kernel.",
                      1e3 * fraction * now, 1e3 * now, goal()));
      return;
    }
  }

  void rate() {
    DesignProblem other = request_;
    other.device.timing.period_s *= 0.5;
    if (!candidate_.holds(same_targets(other)))
      return;
    out_.push_back(fmt::format("At {:.4g} Hz (now {:.4g}), if the device supports it, {}.",
                               1.0 / other.device.timing.period_s,
                               1.0 / request_.device.timing.period_s, goal()));
  }

  void cap() {
    if (!short_of_)
      return cap_for_cutoff();
    if (request_.goals.free_cap)
      return;
    std::string caps;
    for (std::size_t a = 0; a < problems_.size(); ++a) {
      const AxisProblem& p = problems_[a];
      const double fits =
          damped_stiffness(p, candidate_.laws.front()[a],
                           std::min(p.target, certified_stiffness(p, candidate_.laws.front()[a])));
      if (fits < std::min(p.useful, p.target) || fits < p.contact.one_point)
        return;
      caps += fmt::format("{}{:.3g} {}", caps.empty() ? "" : " and ", fits, p.units->stiffness);
    }
    out_.push_back(fmt::format(
        "With a cap of {} on all points together each point keeps its stiffness (gain 1).", caps));
  }
  void cap_for_cutoff() {
    if (design_.spec.kind != "shaping_filter")
      return;
    std::string caps;
    for (std::size_t a = 0; a < problems_.size(); ++a) {
      const AxisProblem& p = problems_[a];
      double fits = 0.0;
      for (const auto& laws : candidate_.laws)
        fits = std::max(fits, certified_stiffness(p, laws[a], fits));
      if (fits < p.useful)
        return;
      caps += fmt::format("{}{:.3g} {}", caps.empty() ? "" : " and ", std::min(fits, p.target),
                          p.units->stiffness);
    }
    out_.push_back(fmt::format("With the contact stiffness capped at {}, {}.", caps, goal()));
  }

  void grip() {
    const bool passive =
        std::ranges::any_of(problems_, [](const AxisProblem& p) { return p.hand.any_passive; });
    if (passive) {
      out_.push_back("A specified range of hands allows more stiffness than `any_passive`.");
      return;
    }
    DesignProblem other = request_;
    const bool released = request_.hand.translation.may_release ||
                          (problems_.size() > 1 && request_.hand.rotation.may_release);
    other.hand.translation.may_release = other.hand.rotation.may_release = false;
    if (released && candidate_.holds(same_targets(other))) {
      out_.push_back(fmt::format("If the device is never released in contact, {}.", goal()));
      return;
    }
    for (const double fraction : kGripRatios) {
      tighten(other.hand.translation, request_.hand.translation, fraction);
      tighten(other.hand.rotation, request_.hand.rotation, fraction);
      if (!candidate_.holds(same_targets(other)))
        continue;
      out_.push_back(fmt::format(
          "If the device is never released and always gripped firmly, with at least {}, {}.",
          grips(other), goal()));
      return;
    }
  }
  static void tighten(HandRange& hand, const HandRange& from, double fraction) {
    hand.mass_min = std::lerp(from.mass_min, from.mass_max, fraction);
    hand.damping_min = std::lerp(from.damping_min, from.damping_max, fraction);
    hand.stiffness_min = std::lerp(from.stiffness_min, from.stiffness_max, fraction);
  }
  std::string grips(const DesignProblem& other) const {
    std::string out;
    for (const AxisProblem& p : problems_) {
      const HandRange& hand =
          p.units == &kRotationUnits ? other.hand.rotation : other.hand.translation;
      out += fmt::format("{}{:.3g} {} and {:.3g} {}", out.empty() ? "" : ", ", hand.stiffness_min,
                         p.units->stiffness, hand.damping_min, p.units->damping);
    }
    return out;
  }

  std::vector<AxisProblem> same_targets(const DesignProblem& other) const {
    std::vector<AxisProblem> problems = axis_problems(other);
    for (std::size_t a = 0; a < problems.size(); ++a)
      problems[a].target = problems_[a].target;
    if (damped_)
      set_min_damping(other, problems);
    return problems;
  }

  const DesignProblem& request_;
  const std::vector<AxisProblem>& problems_;
  const Design& design_;
  bool short_of_, damped_ = false;
  RemedyCandidate candidate_;
  std::vector<std::string> out_;
};

}  // namespace

std::vector<std::string> remedies_of(const DesignProblem& request,
                                     const std::vector<AxisProblem>& problems,
                                     const Design& design) {
  if (design.status == DesignStatus::kAsRequested)
    return {};
  return Remedies(request, problems, design).all();
}

}  // namespace voxtouch::coupling::design
