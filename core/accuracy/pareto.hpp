#pragma once
/// Which of many settings are worth choosing at all.
#include <cstddef>
#include <optional>
#include <vector>

namespace voxtouch::accuracy {

/// What a setting costs and how wrong it is; less is better in both. One that is not finite takes
/// no part.
struct CostError {
  double cost = 0.0, error = 0.0;
};

/// The Pareto front: indices of all points that no other point beats (as good in both figures,
/// better in one), by ascending cost, equals by index. Of points that are equal in both figures
/// none beats another: all of them are on it.
std::vector<std::size_t> pareto_front(const std::vector<CostError>& points);

/// The point of `front` (of pareto_front) where the gain turns: farthest below the chord between
/// the front's ends, both figures logarithmic and scaled to the ends (Satopaa et al. 2011, "Finding
/// a Kneedle in a Haystack", eq. of the difference curve). None where the front has no point below
/// its chord, fewer than three points, or one whose cost is 0. Errors below `least_error` (> 0)
/// count as that, since zero has no logarithm.
std::optional<std::size_t> knee(const std::vector<CostError>& points,
                                const std::vector<std::size_t>& front, double least_error);

}  // namespace voxtouch::accuracy
