#pragma once
/// Steps 1 to 4 of the design of a shaping filter, or of a coupling without any: which cut-off,
/// damping ratio and injected damping give the goal with the least given up, or else the most
/// stiffness.
#include <array>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/design_axis.hpp"
#include "core/coupling/design/loop_table.hpp"

namespace voxtouch::coupling::design {

/// Velocities that injected damping is tried on, those of filters first.
inline constexpr std::array<VelocityEstimate, 6> kVelocityEstimates{
    {{50.0}, {100.0}, {200.0}, {100.0, 3}, {100.0, 4}, {100.0, 5}}};

/// All of them, or those of filters.
constexpr std::span<const VelocityEstimate> velocity_estimates(bool windows) {
  return std::span(kVelocityEstimates).first(windows ? kVelocityEstimates.size() : 3);
}

/// w0 / (2 pi) and d; a cut-off of infinity is no filter at all.
struct FilterSetting {
  double cutoff_hz = 0.0, damping_ratio = 1.0;
};
/// The law of that shape, of unit gain and without injected damping.
LoopController law_of(const FilterSetting& shape);

/// What may be tried, the goal first, then raised: requested cut-off x {1, 1.5, 2, ... 40} while w0
/// T
/// <= 0.6 and below the goal's highest; at each the damping ratios .707, .577 and 1, and where only
/// passivity is known of a hand also .866, which rule P likes best.
std::vector<FilterSetting> filter_settings(const DesignProblem& request);

/// A LoopTable behind filters, which remembers its answers.
class FilterTable {
 public:
  FilterTable(const std::vector<DesignCase>& cases, std::span<const VelocityEstimate> velocities,
              LoopLimit limit = LoopLimit::kStable)
      : table_(cases, velocities, limit) {}
  /// `LoopTable::critical` behind `shape`; where it is below `enough`, some number below.
  double critical(const FilterSetting& shape, std::size_t velocity, double injected_damping,
                  double enough, double damping_force_ratio = 0.0, double large_swing = 1.0);

 private:
  /// Cut-off, damping ratio, velocity, injected damping, ratio, large swing: all that the answer
  /// depends on.
  using Question = std::tuple<double, double, std::size_t, double, double, double>;
  struct Answer {
    double critical, enough;
  };
  LoopTable table_;
  FilterSetting used_{0.0, 0.0};
  std::map<Question, Answer> known_;
};

/// What the searches of one design share: with floors and without, bounded and not, for a filter
/// and for none, the cases are the same.
struct CandidateCache {
  std::vector<std::optional<FilterTable>>
      tables;  ///< of each axis of which more than passivity is known of the hand
  std::optional<SpringDamperPair> spring_damper;  ///< the stiffest on the cases
};

struct FilterChoice {
  FilterSetting shape;
  VelocityEstimate velocity;
  std::vector<double> damping;  ///< injected, for each problem
  /// kAsRequested, kBandwidthRaised or kDampingAdded: the targets hold, exactly. kStiffnessReduced:
  /// they do not anywhere.
  DesignStatus status = DesignStatus::kStiffnessReduced;
};

/// Injected damping is tried on the velocity estimates, 10 to 100 % of what each allows; the least
/// that does, and among equals the lowest cut-off. Where none does, the least that shows nine
/// tenths of the best, and on no axis less than a filter would. With two axes "least" is the larger
/// fraction of the most that the axis could have.
FilterChoice search_filter(const std::vector<AxisProblem>& problems,
                           const std::vector<FilterSetting>& shapes, bool allow_injected_damping,
                           bool velocity_windows, CandidateCache& cache);

}  // namespace voxtouch::coupling::design
