#pragma once
/// A tree of spheres over the tool's features of one kind, one feature a leaf.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/exact/normal_cone.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// A feature's ball in the tool's frame [m].
struct Ball {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;
};

/// Immutable once built; the root is node 0. Allocates when built.
class ElementTree {
 public:
  struct Node {
    Ball ball;
    NormalCone cone;            ///< of the normals of all elements
    std::uint32_t next = 0;     ///< the second child; the first follows its parent
    std::uint32_t element = 0;  ///< index of the ball in the middle; of a leaf the only one
    std::uint32_t count = 0;    ///< of elements
    double spread_m = 0.0;      ///< no point of any element is farther from `element`; infinite
                                ///< above kSpreadElements
    bool leaf = false;
  };
  /// No point of element `to` is farther than this from element `from` [m].
  using Spread = std::function<double(std::uint32_t from, std::uint32_t to)>;
  static constexpr std::size_t kSpreadElements = 16;

  /// `cones`: of each element's normals; empty: any direction.
  ElementTree(std::span<const Ball> balls, const Spread& spread,
              std::span<const NormalCone> cones = {});

  const std::vector<Node>& nodes() const noexcept { return nodes_; }
  std::size_t elements() const noexcept { return elements_; }
  std::size_t bytes() const noexcept { return nodes_.size() * sizeof(Node); }

 private:
  void build(std::span<const Ball> balls, const Spread& spread, std::span<const NormalCone> cones,
             std::span<std::uint32_t> order);

  std::size_t elements_;
  std::vector<Node> nodes_;
};

}  // namespace voxtouch::exact
