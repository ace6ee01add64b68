#pragma once
/// Steps 1 to 4 of the design of a shaping filter, or of a coupling without filter. They find the
/// cut-off, damping ratio and injected damping that meet the goal at the least cost, or else give
/// the largest stiffness.
#include <array>
#include <span>
#include <vector>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/design_axis.hpp"
#include "core/coupling/design/loop_table.hpp"

namespace voxtouch::coupling::design {

/// Velocity estimates that are tried for injected damping: slow filters, filters, windows.
inline constexpr std::array<VelocityEstimate, 8> kVelocityEstimates{
    {{12.5}, {25.0}, {50.0}, {100.0}, {200.0}, {100.0, 3}, {100.0, 4}, {100.0, 5}}};

/// All of them, or without the slow filters, where an encoder step is small anyway, or without the
/// windows.
constexpr std::span<const VelocityEstimate> velocity_estimates(bool slow, bool windows) {
  const std::size_t first = slow ? 0 : 2, last = windows ? kVelocityEstimates.size() : 5;
  return std::span(kVelocityEstimates).subspan(first, last - first);
}

/// w0 / (2 pi) and d; an infinite cut-off means no filter.
struct FilterSetting {
  double cutoff_hz = 0.0, damping_ratio = 1.0;
};
/// The law of that shape, with unit gain and without injected damping.
LoopController law_of(const FilterSetting& shape);

/// The candidate settings, the goal first, then raised. They are the requested cut-off x {1, 1.5,
/// 2, ... 40} while w0 T <= 0.6 and below the highest cut-off of the goal. At each cut-off the
/// damping ratios are .707, .577 and 1. For a hand only known to be passive, .866 is added, at
/// which rule P allows the largest stiffness.
std::vector<FilterSetting> filter_settings(const DesignProblem& request);

struct FilterChoice {
  FilterSetting shape;
  VelocityEstimate velocity;
  std::vector<double> damping;  ///< injected damping for each problem
  /// kAsRequested, kBandwidthRaised or kDampingAdded: the targets are met exactly.
  /// kStiffnessReduced: no candidate meets them.
  DesignStatus status = DesignStatus::kStiffnessReduced;
};

/// Searches for the least injected damping that meets the targets.
/// It is tried on all velocity estimates at 10 to 100 % of the allowed value; among equals the
/// lowest cut-off is chosen. If no damping suffices, the result is the least that displays nine
/// tenths of the best, and on no axis less than a filter would. With two axes, "least" refers to
/// the larger fraction of the allowed damping.
FilterChoice search_filter(const std::vector<AxisProblem>& problems,
                           const std::vector<FilterSetting>& shapes, bool allow_injected_damping,
                           bool velocity_windows);

}  // namespace voxtouch::coupling::design
