#include "core/accuracy/pareto.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace voxtouch::accuracy {

std::vector<std::size_t> pareto_front(const std::vector<CostError>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(points[i].cost) && std::isfinite(points[i].error))
      order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tuple(points[a].cost, points[a].error, a) <
           std::tuple(points[b].cost, points[b].error, b);
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    const bool equals_last = !front.empty() && points[front.back()].cost == points[i].cost &&
                             points[front.back()].error == points[i].error;
    if (!(points[i].error < least) && !equals_last)
      continue;
    least = points[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> knee(const std::vector<CostError>& points,
                                const std::vector<std::size_t>& front, double least_error) {
  if (front.size() < 3)
    return std::nullopt;
  const auto error = [&](std::size_t i) {
    return std::log(std::max(points[i].error, least_error));
  };
  const std::size_t first = front.front(), last = front.back();
  if (!(points[first].cost > 0.0))
    return std::nullopt;
  const double wide = std::log(points[last].cost / points[first].cost),
               high = error(first) - error(last);
  if (!(wide > 0.0) || !(high > 0.0))
    return std::nullopt;
  std::optional<std::size_t> best;
  double farthest = 1e-12;  // on the chord, up to rounding, is not below it
  for (const std::size_t i : front) {
    // The chord runs from (0, 1) to (1, 0): a point is below it by 1 - x - y.
    const double x = std::log(points[i].cost / points[first].cost) / wide,
                 y = (error(i) - error(last)) / high;
    if (1.0 - x - y <= farthest)
      continue;
    farthest = 1.0 - x - y;
    best = i;
  }
  return best;
}

}  // namespace voxtouch::accuracy
