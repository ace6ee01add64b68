#include "core/exact/element_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/exact/box_tree.hpp"

namespace voxtouch::exact {

ElementTree::ElementTree(std::span<const Ball> balls, const Spread& spread,
                         std::span<const NormalCone> cones)
    : elements_(balls.size()) {
  std::vector<std::uint32_t> order(balls.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(2 * balls.size());
  if (!balls.empty())
    build(balls, spread, cones, order);
}

void ElementTree::build(std::span<const Ball> balls, const Spread& spread,
                        std::span<const NormalCone> cones, std::span<std::uint32_t> order) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  NormalCone cone = cones.empty() ? NormalCone::all() : NormalCone();
  if (!cones.empty())
    for (const std::uint32_t element : order)
      cone.add(cones[element]);
  if (order.size() == 1) {
    nodes_[self] = {balls[order[0]], cone, 0, order[0], 1, 0.0, true};
    return;
  }
  Box centres;
  for (const std::uint32_t element : order)
    centres.add(balls[element].centre);
  Ball ball{centres.centre(), 0.0};
  for (const std::uint32_t element : order) {
    const double reach = (balls[element].centre - ball.centre).norm() + balls[element].radius;
    ball.radius = std::max(ball.radius, reach);
  }
  const auto nearer = [&](std::uint32_t a, std::uint32_t b) {
    return (balls[a].centre - ball.centre).norm() < (balls[b].centre - ball.centre).norm();
  };
  Node& node = nodes_[self];
  node.ball = ball;
  node.cone = cone;
  node.element = *std::min_element(order.begin(), order.end(), nearer);
  node.count = static_cast<std::uint32_t>(order.size());
  node.spread_m = std::numeric_limits<double>::infinity();
  if (order.size() <= kSpreadElements) {
    node.spread_m = 0.0;
    for (const std::uint32_t element : order)
      node.spread_m = std::max(node.spread_m, spread(node.element, element));
  }
  Eigen::Index axis = 0;
  (centres.high - centres.low).maxCoeff(&axis);
  const std::size_t middle = order.size() / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double x = balls[a].centre[axis], y = balls[b].centre[axis];
    return x != y ? x < y : a < b;
  };
  std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(middle), order.end(),
                   before);
  build(balls, spread, cones, order.first(middle));
  nodes_[self].next = static_cast<std::uint32_t>(nodes_.size());
  build(balls, spread, cones, order.subspan(middle));
}

}  // namespace voxtouch::exact
