#pragma once
/// A tree of axis-aligned boxes over the features of a mesh, for range queries.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "core/exact/normal_cone.hpp"
#include "core/exact/work.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::exact {

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = Vec3::Constant(-std::numeric_limits<double>::infinity());

  void add(const Vec3& point) noexcept {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  void add(const Box& box) noexcept {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  Vec3 centre() const noexcept { return 0.5 * (low + high); }
};

/// Least distance of two boxes [m].
inline double distance(const Box& a, const Box& b) noexcept {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

/// Built once, in the given order of boxes; the same boxes give the same tree. Items are indices of
/// boxes.
class BoxTree {
 public:
  /// `cones`: of each item's normals; empty: any direction. Allocates.
  explicit BoxTree(std::span<const Box> boxes, std::span<const NormalCone> cones = {});

  bool empty() const noexcept { return nodes_.empty(); }
  std::size_t bytes() const noexcept {
    return nodes_.size() * sizeof(Node) + items_.size() * sizeof(std::uint32_t);
  }
  const Box& bounds() const noexcept { return nodes_.front().box; }

  /// How a walk ended.
  struct Walked {
    double beyond_m =
        std::numeric_limits<double>::infinity();  ///< no item that was not visited is nearer
    bool whole =
        true;  ///< false: the visitor or the limit of work ended it; `beyond_m` means nothing then
  };

  /// A node, and a lower bound of the distance of everything outside it.
  struct Entry {
    std::uint32_t node = 0;
    double outside_m = std::numeric_limits<double>::infinity();
    bool near = true;  ///< false: nothing is within the range; `node` means nothing then
  };

  /// The smallest node under `from` that holds all items within `range_m`. What lies in the ball or
  /// box that `bound` is of may walk from there. Real-time safe.
  template <class Bound>
  Entry enter(const Bound& bound, double range_m, Entry from, Work& work) const noexcept;

  /// Calls `visit(item)` for each item in nodes for which `bound(box)` or `bound(box, cone)`, a
  /// lower bound of the distance, is at most `range_m`, nearer nodes first; it ends where `visit`
  /// returns false. The visitor may lower `range_m` meanwhile. Real-time safe.
  template <class Bound, class Visit>
  Walked walk(const Bound& bound, const double& range_m, Visit&& visit, Work& work,
              const Entry& from) const noexcept;
  template <class Bound, class Visit>
  Walked walk(const Bound& bound, const double& range_m, Visit&& visit, Work& work) const noexcept {
    return walk(bound, range_m, visit, work, Entry{});
  }

 private:
  struct Node {
    Box box;
    NormalCone cone;          ///< of all items under it
    std::uint32_t next = 0;   ///< the second child; the first follows its parent
    std::uint32_t first = 0;  ///< of the leaf's items
    std::uint32_t count = 0;  ///< 0: no leaf
  };
  static constexpr std::uint32_t kLeafItems = 2;
  static constexpr std::size_t kMaxDepth = 64;

  void build(std::span<const Box> boxes, std::span<const NormalCone> cones, std::uint32_t first,
             std::uint32_t last);
  template <class Bound>
  double bound_of(const Bound& bound, std::uint32_t node) const noexcept {
    if constexpr (std::is_invocable_v<Bound, const Box&, const NormalCone&>)
      return bound(nodes_[node].box, nodes_[node].cone);
    else
      return bound(nodes_[node].box);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

template <class Bound>
BoxTree::Entry BoxTree::enter(const Bound& bound, double range_m, Entry from,
                              Work& work) const noexcept {
  for (;;) {
    const Node& node = nodes_[from.node];
    if (node.count > 0)
      return from;
    const double to_first = bound_of(bound, from.node + 1);
    const double to_second = bound_of(bound, node.next);
    work.add(2);
    if (to_first <= range_m && to_second <= range_m)
      return from;
    from.outside_m = std::min(from.outside_m, std::max(to_first, to_second));
    if (to_first > range_m && to_second > range_m) {
      from.outside_m = std::min({from.outside_m, to_first, to_second});
      from.near = false;
      return from;
    }
    from.node = to_first <= range_m ? from.node + 1 : node.next;
  }
}

template <class Bound, class Visit>
BoxTree::Walked BoxTree::walk(const Bound& bound, const double& range_m, Visit&& visit, Work& work,
                              const Entry& from) const noexcept {
  Walked walked;
  walked.beyond_m = from.outside_m;
  if (nodes_.empty() || !from.near)
    return walked;
  const double to_root = bound_of(bound, from.node);
  work.add(1);
  if (to_root > range_m)
    return {std::min(to_root, from.outside_m), true};
  struct Waiting {
    std::uint32_t node;
    double bound_m;
  };
  std::array<Waiting, kMaxDepth> stack;
  std::size_t waiting = 0;
  std::uint32_t at = from.node;
  for (;;) {
    const Node& node = nodes_[at];
    if (node.count > 0) {
      for (std::uint32_t k = 0; k < node.count; ++k)
        if (!visit(items_[node.first + k]))
          return {0.0, false};
      if (work.done())
        return {0.0, false};
    } else {
      std::uint32_t near = at + 1, far = node.next;
      double to_near = bound_of(bound, near), to_far = bound_of(bound, far);
      work.add(2);
      if (to_far < to_near) {
        std::swap(near, far);
        std::swap(to_near, to_far);
      }
      if (to_far > range_m) {
        walked.beyond_m = std::min(walked.beyond_m, to_far);
      } else {
        stack[waiting++] = {far, to_far};
      }
      if (to_near <= range_m) {
        at = near;
        continue;
      }
      walked.beyond_m = std::min(walked.beyond_m, to_near);
    }
    for (; waiting > 0 && stack[waiting - 1].bound_m > range_m; --waiting)
      walked.beyond_m = std::min(walked.beyond_m, stack[waiting - 1].bound_m);
    if (waiting == 0)
      return walked;
    at = stack[--waiting].node;
  }
}

}  // namespace voxtouch::exact
