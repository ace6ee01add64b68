#include "core/coupling/design/filter_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>

#include "core/coupling/design/loop_table.hpp"
#include "core/coupling/design/min_damping_ratio.hpp"

namespace voxtouch::coupling::design {
namespace {

using Law = LoopController::Law;
constexpr std::array kFactors{1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 40.0};
/// Without injected damping: the default of the specification.
constexpr VelocityEstimate kUnused{100.0};
constexpr std::size_t kLevels = 11;  ///< 0, 10, ... 100 % of the allowed damping
/// The table is accurate to about one percent, so a value slightly below the target is verified
/// exactly.
constexpr double kTableTolerance = 0.985;
/// Of all candidates within a tenth of the best stiffness, the gentlest is chosen.
constexpr double kNearBestRatio = 0.9;
constexpr std::size_t kMaxConfirmations = 24;

struct Axis {
  const AxisProblem* problem;
  std::optional<LoopTable> table;  ///< empty if rule P decides
  std::optional<LoopTable>
      damped_table;  ///< of the cases with a minimum damping ratio; empty without such cases
  std::array<double, kVelocityEstimates.size()> most_damping{};
  /// Whether a minimum damping ratio is missed although the contact is negligible: an underdamped
  /// hand needs some damping, and too much damping acts late. Empty: not yet computed.
  std::array<std::array<std::optional<bool>, kLevels>, kVelocityEstimates.size()> misses_minimum{};
  double reference_damping = 0.0;    ///< maximum over the velocity estimates
  std::size_t last_missed_case = 0;  ///< the last case that missed its minimum

  double damping(std::size_t velocity, std::size_t level) const {
    return most_damping[velocity] * static_cast<double>(level) / (kLevels - 1);
  }
  double fraction(std::size_t velocity, std::size_t level) const {
    return level == 0 ? 0.0 : damping(velocity, level) / reference_damping;
  }
};

/// A point of the search and its cost.
struct Candidate {
  std::size_t shape = 0, velocity = 0;
  std::vector<std::size_t> levels;
  double cost = 0.0, second_cost = 0.0;  ///< larger and summed fraction of injected damping

  auto order(const std::vector<FilterSetting>& shapes) const {
    return std::tuple(cost, second_cost, shapes[shape].cutoff_hz, shape, velocity);
  }
};

bool has_minimum(const DesignCase& one) { return one.least_damping_ratio > 0.0; }

class Search {
 public:
  Search(const std::vector<AxisProblem>& problems, const std::vector<FilterSetting>& shapes,
         bool allow_damping, bool windows)
      : shapes_(shapes),
        allow_damping_(allow_damping),
        velocities_(velocity_estimates(may_bounce(problems[0]), windows)) {
    for (const AxisProblem& problem : problems) {
      Axis& axis = axes_.emplace_back();
      axis.problem = &problem;
      if (!problem.hand.any_passive)
        axis.table.emplace(problem.cases, velocities_);
      if (std::ranges::any_of(problem.cases, has_minimum))
        axis.damped_table.emplace(problem.cases, velocities_, LoopLimit::kDamped);
    }
  }

  FilterChoice run() {
    if (auto found = without_damping())
      return *found;
    if (may_damp())
      bound_damping();
    tabulate();
    if (may_damp())
      if (auto found = with_damping())
        return *found;
    return stiffest();
  }

 private:
  bool may_damp() const {
    return allow_damping_ &&
           std::ranges::any_of(axes_, [](const Axis& a) { return a.table.has_value(); });
  }

  /// Puts the filter in front of all tables.
  void use(const FilterSetting& shape) {
    const auto law = [&](const DecayingPhasor& at, double period_s) {
      const double half_angle = std::numbers::pi * shape.cutoff_hz * period_s;
      return std::isinf(shape.cutoff_hz) ? Complex(1.0)
                                         : filter_response(half_angle, shape.damping_ratio, at);
    };
    for (Axis& axis : axes_)
      for (std::optional<LoopTable>* table : {&axis.table, &axis.damped_table})
        if (*table)
          (*table)->use(law);
  }

  /// Stiffness over target, by the table or by rule P. If it is below `enough`, the result is some
  /// smaller number. Call `use` for the shape before.
  double ratio(Axis& axis, std::size_t shape, std::size_t velocity, std::size_t level,
               double enough) const {
    const AxisProblem& problem = *axis.problem;
    const double whole = problem.margin * problem.target;
    const double critical =
        axis.table ? axis.table->critical(velocity, axis.damping(velocity, level), enough * whole,
                                          problem.damping_force_ratio, problem.large_swing)
                   : passive_limit(problem, law_of(shapes_[shape]));
    LoopController law;
    law.injected_damping = axis.damping(velocity, level);
    law.use(velocities_[velocity]);
    const double stable =
        std::min(critical / whole, quiet_stiffness(problem, law) / problem.target);
    if (!axis.damped_table || stable < enough)
      return stable;
    return std::min(stable, axis.damped_table->critical(velocity, axis.damping(velocity, level),
                                                        enough * problem.target) /
                                problem.target);
  }

  /// Verifies the candidate exactly by the governing rule.
  bool confirmed(const Candidate& candidate) const {
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const AxisProblem& problem = *axes_[a].problem;
      if (!(certified_stiffness(problem, law(candidate, a), problem.target) >= problem.target))
        return false;
      if (!meets_min_damping(problem, law(candidate, a), problem.target))
        return false;
    }
    return true;
  }
  LoopController law(const Candidate& candidate, std::size_t a) const {
    LoopController out = law_of(shapes_[candidate.shape]);
    out.injected_damping = axes_[a].damping(candidate.velocity, candidate.levels[a]);
    out.use(velocities_[candidate.velocity]);
    return out;
  }
  FilterChoice chosen(const Candidate& candidate, DesignStatus status) const {
    FilterChoice out{shapes_[candidate.shape],
                     candidate.cost > 0.0 ? velocities_[candidate.velocity] : kUnused,
                     {},
                     status};
    for (std::size_t a = 0; a < axes_.size(); ++a)
      out.damping.push_back(axes_[a].damping(candidate.velocity, candidate.levels[a]));
    return out;
  }

  /// Steps 1 and 2.
  std::optional<FilterChoice> without_damping() {
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      const Candidate candidate{s, 0, std::vector<std::size_t>(axes_.size(), 0), 0.0, 0.0};
      bool likely = true;
      use(shapes_[s]);
      for (Axis& axis : axes_)
        likely = likely && ratio(axis, s, 0, 0, kTableTolerance) >= kTableTolerance;
      if (!likely || !confirmed(candidate))
        continue;
      const bool requested = shapes_[s].cutoff_hz == shapes_.front().cutoff_hz;
      return chosen(candidate,
                    requested ? DesignStatus::kAsRequested : DesignStatus::kBandwidthRaised);
    }
    return std::nullopt;
  }

  void bound_damping() {
    for (Axis& axis : axes_) {
      if (!axis.table)
        continue;
      for (std::size_t v = 0; v < velocities_.size(); ++v) {
        axis.most_damping[v] = damping_limit(*axis.problem, velocities_[v]);
        axis.reference_damping = std::max(axis.reference_damping, axis.most_damping[v]);
      }
    }
  }

  bool misses_min_damping(Axis& axis, std::size_t velocity, std::size_t level) const {
    if (!axis.damped_table)
      return false;
    constexpr double kHardlyAny = 1e-3;  // of the target
    std::optional<bool>& misses_minimum = axis.misses_minimum[level == 0 ? 0 : velocity][level];
    if (!misses_minimum) {
      LoopController law = law_of({kInfinity, 1.0});
      law.use(velocities_[velocity]);
      law.injected_damping = axis.damping(velocity, level);
      misses_minimum = !meets_min_damping(*axis.problem, law, kHardlyAny * axis.problem->target,
                                          axis.last_missed_case);
    }
    return *misses_minimum;
  }

  /// All ratios of all points that the next steps may use; [shape][velocity estimate][axis][level].
  void tabulate() {
    ratios_.assign(shapes_.size(), {});
    best_ = 0.0;
    for (std::size_t s = shapes_.size();
         s-- > 0;) {  // the highest cut-off first, so that most others are rejected early
      use(shapes_[s]);
      for (std::size_t v = 0; v < velocities_.size(); ++v) {
        ratios_[s][v].resize(axes_.size());
        const double enough =
            kNearBestRatio * std::min(best_, 1.0);  // no step uses a smaller ratio
        double joint = kInfinity;
        for (std::size_t a = 0; a < axes_.size() && joint >= enough; ++a) {
          for (std::size_t level = 0; level < kLevels; ++level) {
            const bool same = level > 0 && axes_[a].damping(v, level) == 0.0;
            ratios_[s][v][a][level] =
                same ? ratios_[s][v][a][0] : ratio(axes_[a], s, v, level, enough);
          }
          joint = std::min(joint, *std::ranges::max_element(ratios_[s][v][a]));
        }
        if (velocities_[v].window == 0)
          best_ = std::max(best_, joint_above(best_, s, v));
      }
    }
  }

  /// Displayed stiffness of the axis there, above `least`. 0 if a minimum damping ratio is missed
  /// although the contact is negligible; that is slow to compute, so only relevant points are
  /// checked.
  bool reaches_ratio(std::size_t shape, std::size_t velocity, std::size_t axis, std::size_t level,
                     double least) {
    return ratios_[shape][velocity][axis][level] >= least &&
           (least <= 0.0 || !misses_min_damping(axes_[axis], velocity, level));
  }
  double ratio(const Candidate& candidate, std::size_t axis) {
    const std::size_t level = candidate.levels[axis];
    return misses_min_damping(axes_[axis], candidate.velocity, level)
               ? 0.0
               : ratios_[candidate.shape][candidate.velocity][axis][level];
  }
  /// The largest common ratio of the axes; 0 if it does not exceed `least`.
  double joint_above(double least, std::size_t shape, std::size_t velocity) {
    double joint = kInfinity;
    for (const Levels& levels : ratios_[shape][velocity])
      joint = std::min(joint, *std::ranges::max_element(levels));
    for (std::size_t a = 0; a < axes_.size() && joint > least; ++a) {
      Levels levels = ratios_[shape][velocity][a];
      auto most = std::ranges::max_element(levels);
      for (; *most > least && misses_min_damping(axes_[a], velocity,
                                                 static_cast<std::size_t>(most - levels.begin()));
           most = std::ranges::max_element(levels))
        *most = 0.0;
      joint = std::min(joint, *most);
    }
    return joint > least ? joint : 0.0;
  }

  /// The gentlest point of each shape and velocity estimate at which every axis reaches `least` of
  /// its target, and the ratio of `no_less`; the gentlest first.
  std::vector<Candidate> reaching(double least, bool windows = true,
                                  const Candidate* no_less = nullptr) {
    std::vector<Candidate> out;
    for (std::size_t s = 0; s < shapes_.size(); ++s)
      for (std::size_t v = 0; v < velocities_.size(); ++v) {
        if (!windows && velocities_[v].window > 0)
          continue;
        Candidate candidate{s, v, {}, 0.0, 0.0};
        for (std::size_t a = 0; a < axes_.size(); ++a) {
          const double enough = no_less ? std::max(least, ratio(*no_less, a)) : least;
          std::size_t level = 0;
          while (level < kLevels && !reaches_ratio(s, v, a, level, enough))
            ++level;
          if (level == kLevels)
            break;
          candidate.levels.push_back(level);
          const double fraction = axes_[a].fraction(v, candidate.levels.back());
          candidate.cost = std::max(candidate.cost, fraction), candidate.second_cost += fraction;
        }
        if (candidate.levels.size() == axes_.size())
          out.push_back(std::move(candidate));
      }
    std::ranges::sort(out, [&](const Candidate& x, const Candidate& y) {
      return x.order(shapes_) < y.order(shapes_);
    });
    return out;
  }

  /// Step 3.
  std::optional<FilterChoice> with_damping() {
    std::size_t confirmations = 0;
    for (const Candidate& candidate : reaching(kTableTolerance)) {
      if (++confirmations > kMaxConfirmations)
        break;
      if (confirmed(candidate))
        return chosen(candidate, DesignStatus::kDampingAdded);
    }
    return std::nullopt;
  }

  /// The ratio that counts as equal to the best, over all velocity estimates or those of filters
  /// only.
  double near_best_ratio(bool windows) {
    double best = 0.0;
    for (std::size_t s = 0; s < shapes_.size(); ++s)
      for (std::size_t v = 0; v < velocities_.size(); ++v)
        if (windows || velocities_[v].window == 0)
          best = std::max(best, joint_above(best, s, v));
    return kNearBestRatio * std::min(best, 1.0);
  }

  /// Step 4. With a window, no axis displays less than with the filter that would be chosen without
  /// windows.
  FilterChoice stiffest() {
    const Candidate filter = reaching(near_best_ratio(false), false).front();
    for (const double least : {near_best_ratio(true), 0.0})
      if (const auto found = reaching(least, true, &filter); !found.empty())
        return chosen(found.front(), DesignStatus::kStiffnessReduced);
    return chosen(filter, DesignStatus::kStiffnessReduced);
  }

  const std::vector<FilterSetting>& shapes_;
  bool allow_damping_;
  std::span<const VelocityEstimate> velocities_;
  std::vector<Axis> axes_;
  double best_ = 0.0;  ///< ratio of all axes together, on a filter's velocity
  using Levels = std::array<double, kLevels>;
  std::vector<std::array<std::vector<Levels>, kVelocityEstimates.size()>> ratios_;
};

}  // namespace

LoopController law_of(const FilterSetting& shape) {
  LoopController law;
  const bool none = std::isinf(shape.cutoff_hz);
  law.law = none ? Law::kDirect : Law::kShapingFilter;
  law.w0_rad_per_s = none ? 0.0 : 2.0 * std::numbers::pi * shape.cutoff_hz;
  law.damping_ratio = shape.damping_ratio;
  return law;
}

std::vector<FilterSetting> filter_settings(const DesignProblem& request) {
  const bool passive = request.hand.translation.any_passive ||
                       (request.device.gives_torque && request.hand.rotation.any_passive);
  std::vector<double> ratios{std::numbers::sqrt2 / 2.0, 0.577, 1.0};
  if (passive)
    ratios.insert(ratios.begin() + 1, std::numbers::sqrt3 / 2.0);
  std::vector<FilterSetting> shapes;
  for (const double factor : kFactors) {
    const double cutoff = request.goals.cutoff_hz * factor;
    const double angle_per_sample =
        2.0 * std::numbers::pi * cutoff * request.device.timing.period_s;
    // The goal itself is tried unchanged; `check` refuses a cut-off that no filter can have.
    if (factor > 1.0 && (angle_per_sample > kWarnCutoffRad || cutoff > request.goals.max_cutoff_hz))
      break;
    for (const double ratio : ratios)
      shapes.push_back({cutoff, ratio});
  }
  return shapes;
}

FilterChoice search_filter(const std::vector<AxisProblem>& problems,
                           const std::vector<FilterSetting>& shapes, bool allow_injected_damping,
                           bool velocity_windows) {
  return Search(problems, shapes, allow_injected_damping, velocity_windows).run();
}

}  // namespace voxtouch::coupling::design
