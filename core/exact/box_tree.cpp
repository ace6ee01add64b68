#include "core/exact/box_tree.hpp"

#include <numeric>

namespace voxtouch::exact {

BoxTree::BoxTree(std::span<const Box> boxes, std::span<const NormalCone> cones)
    : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0U);
  nodes_.reserve(boxes.size());
  if (!boxes.empty())
    build(boxes, cones, 0, static_cast<std::uint32_t>(boxes.size()));
}

/// Halves the items at the median of their centres along the longest side: at most 33 levels for
/// 2^32 items.
void BoxTree::build(std::span<const Box> boxes, std::span<const NormalCone> cones,
                    std::uint32_t first, std::uint32_t last) {
  const std::size_t self = nodes_.size();
  nodes_.emplace_back();
  Box box, centres;
  NormalCone cone = cones.empty() ? NormalCone::all() : NormalCone();
  for (std::uint32_t k = first; k < last; ++k) {
    box.add(boxes[items_[k]]);
    if (!cones.empty())
      cone.add(cones[items_[k]]);
    centres.add(boxes[items_[k]].centre());
  }
  nodes_[self].box = box;
  nodes_[self].cone = cone;
  if (last - first <= kLeafItems) {
    nodes_[self].first = first;
    nodes_[self].count = last - first;
    return;
  }
  Eigen::Index axis = 0;
  (centres.high - centres.low).maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double x = boxes[a].centre()[axis], y = boxes[b].centre()[axis];
    return x != y ? x < y : a < b;
  };
  const auto begin = items_.begin();
  std::nth_element(begin + first, begin + middle, begin + last, before);
  build(boxes, cones, first, middle);
  nodes_[self].next = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, cones, middle, last);
}

}  // namespace voxtouch::exact
