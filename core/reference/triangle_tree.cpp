#include "core/reference/triangle_tree.hpp"

#include <algorithm>
#include <numeric>

namespace voxtouch::reference {

/// Both trees are descended together. A node of the other tree counts as the ball around its box,
/// since a ball may be rotated.
struct TriangleTree::Search {
  const std::vector<Node>& mine;
  const std::vector<Node>& others;
  const Pose& other_in_mine;
  double reach_m;
  Pairs& found;

  void descend(std::uint32_t at, std::uint32_t other) {
    const Node& node = mine[at];
    const Node& ball = others[other];
    const Vec3 centre = other_in_mine * ball.box.centre();
    const double radius = ball.box.radius();
    const double apart =
        (centre - centre.cwiseMax(node.box.low).cwiseMin(node.box.high)).norm() - radius;
    if (apart > reach_m)
      return;
    const bool leaf = node.second == 0, other_leaf = ball.second == 0;
    if (leaf && other_leaf) {
      found.emplace_back(node.triangle, ball.triangle);
    } else if (other_leaf || (!leaf && node.box.radius() > radius)) {
      descend(at + 1, other);
      descend(node.second, other);
    } else {
      descend(at, other + 1);
      descend(at, ball.second);
    }
  }
};

TriangleTree::TriangleTree(const ReferenceMesh& mesh) {
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box box{mesh.corner(t, 0), mesh.corner(t, 0)};
    for (std::size_t k = 1; k < 3; ++k) {
      box.low = box.low.cwiseMin(mesh.corner(t, k));
      box.high = box.high.cwiseMax(mesh.corner(t, k));
    }
    boxes.push_back(box);
  }
  std::vector<std::uint32_t> order(boxes.size());
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(2 * order.size());
  build(order, 0, order.size(), boxes);
}

void TriangleTree::build(std::vector<std::uint32_t>& order, std::size_t first, std::size_t last,
                         const std::vector<Box>& boxes) {
  const std::size_t here = nodes_.size();
  Node node{boxes[order[first]]};
  node.triangle = order[first];
  for (std::size_t k = first; k < last; ++k) {
    node.box.low = node.box.low.cwiseMin(boxes[order[k]].low);
    node.box.high = node.box.high.cwiseMax(boxes[order[k]].high);
  }
  nodes_.push_back(node);
  if (last - first == 1)
    return;
  Eigen::Index axis = 0;
  (node.box.high - node.box.low).maxCoeff(&axis);
  const auto begin = order.begin();
  const std::size_t middle = first + (last - first) / 2;
  std::stable_sort(begin + static_cast<std::ptrdiff_t>(first),
                   begin + static_cast<std::ptrdiff_t>(last),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return boxes[a].centre()[axis] < boxes[b].centre()[axis];
                   });
  build(order, first, middle, boxes);
  nodes_[here].second = static_cast<std::uint32_t>(nodes_.size());
  build(order, middle, last, boxes);
}

TriangleTree::Pairs TriangleTree::near(const TriangleTree& other, const Pose& other_in_mine,
                                       double reach_m) const {
  Pairs found;
  Search{nodes_, other.nodes_, other_in_mine, reach_m, found}.descend(0, 0);
  return found;
}

}  // namespace voxtouch::reference
