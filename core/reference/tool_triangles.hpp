#pragma once
/// The tool's own triangles, for integrals over its surface.
#include <array>
#include <cstdint>
#include <vector>

#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

/// One triangle of the tool, in T. Triangles of a closed tool face outward for either orientation
/// in its file; an open tool has no outside.
struct ToolTriangle {
  std::array<Vec3, 3> corner;
};

/// Balls around runs of the tool's triangles, as a binary tree in depth-first order.
class ToolTriangles {
 public:
  struct Node {
    Vec3 centre = Vec3::Zero();
    double radius = 0.0;
    std::uint32_t first = 0, last = 0, skip = 0;  ///< triangles; node after this branch
    bool leaf = false;
  };

  /// `pose_TM`: the mesh's frame in T. Allocates.
  ToolTriangles(const ReferenceMesh& mesh, const Pose& pose_TM);
  const std::vector<Node>& nodes() const noexcept { return nodes_; }
  const ToolTriangle& triangle(std::size_t t) const noexcept { return triangles_[t]; }

 private:
  void build(std::uint32_t first, std::uint32_t last);

  std::vector<ToolTriangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace voxtouch::reference
