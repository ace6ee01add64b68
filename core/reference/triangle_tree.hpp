#pragma once
/// Which triangles of two meshes are near each other.
#include <cstdint>
#include <utility>
#include <vector>

#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

/// A binary tree of axis-aligned boxes over the triangles of a mesh, in the mesh's frame.
class TriangleTree {
 public:
  /// Copies what it needs. The mesh has at least one triangle. Allocates.
  explicit TriangleTree(const ReferenceMesh& mesh);

  /// Numbers of triangles: `mine`, `other`.
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  /// All pairs of triangles that are at most `reach_m` apart, and some that are farther; `other` is
  /// posed in this tree's frame. Allocates.
  Pairs near(const TriangleTree& other, const Pose& other_in_mine, double reach_m) const;

 private:
  struct Box {
    Vec3 low, high;
    Vec3 centre() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * (high - low).norm(); }
  };
  /// A leaf has one triangle and no second child. The first child follows its parent.
  struct Node {
    Box box;
    std::uint32_t second = 0;
    std::uint32_t triangle = 0;
  };
  struct Search;

  void build(std::vector<std::uint32_t>& order, std::size_t first, std::size_t last,
             const std::vector<Box>& boxes);

  std::vector<Node> nodes_;
};

}  // namespace voxtouch::reference
