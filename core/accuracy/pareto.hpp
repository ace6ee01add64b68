#pragma once
/// Selects the settings that no other setting dominates.
#include <cstddef>
#include <optional>
#include <vector>

namespace voxtouch::accuracy {

/// Cost and error of a setting; less is better in both. A non-finite one is ignored.
struct CostError {
  double cost = 0.0, error = 0.0;
};

/// The Pareto front: indices of all points that no other point beats (as good in both figures,
/// better in one), by ascending cost, equals by index. Of points that are equal in both figures
/// none beats another: all of them are on it.
std::vector<std::size_t> pareto_front(const std::vector<CostError>& points);

/// The knee of `front` (of pareto_front): the point farthest below the chord between the front's
/// ends, both figures logarithmic and scaled to the ends (Satopaa et al. 2011, "Finding a Kneedle
/// in a Haystack", eq. of the difference curve). Empty if the front has no point below its chord,
/// fewer than three points, or a cost of 0. Errors below `least_error` (> 0) count as that, since
/// zero has no logarithm.
std::optional<std::size_t> knee(const std::vector<CostError>& points,
                                const std::vector<std::size_t>& front, double least_error);

}  // namespace voxtouch::accuracy
