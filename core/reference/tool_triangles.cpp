#include "core/reference/tool_triangles.hpp"

#include <algorithm>
#include <utility>

#include "core/reference/inside_test.hpp"

namespace voxtouch::reference {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr std::size_t kTrianglesOfLeaf = 4;

/// Outward orientation of a triangle of a closed mesh: +1 as stored, -1 inverted.
int outward(const InsideTest& body, const Corners& c) {
  const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).stableNormalized(),
             middle = (c[0] + c[1] + c[2]) / 3.0;
  const double size = std::max({(c[1] - c[0]).norm(), (c[2] - c[0]).norm(), (c[2] - c[1]).norm()});
  const Vec3 step = (1e-6 * size + 1e-12 * middle.cwiseAbs().maxCoeff()) * normal;
  const bool before = body.inside(middle + step), behind = body.inside(middle - step);
  return before && !behind ? -1 : 1;  // both: a wall within the body, which its other half cancels
}

Vec3 centroid(const Corners& c) { return (c[0] + c[1] + c[2]) / 3.0; }

}  // namespace

ToolTriangles::ToolTriangles(const ReferenceMesh& mesh, const Pose& pose_TM) {
  const InsideTest body(mesh);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    ToolTriangle c{{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)}};
    if (mesh.closed && outward(body, c.corner) < 0)
      std::swap(c.corner[1], c.corner[2]);
    for (Vec3& corner : c.corner)
      corner = pose_TM * corner;
    triangles_.push_back(c);
  }
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

void ToolTriangles::build(std::uint32_t first, std::uint32_t last) {
  const std::size_t here = nodes_.size();
  nodes_.emplace_back();
  Vec3 low = triangles_[first].corner[0], high = low;
  for (std::uint32_t t = first; t < last; ++t)
    for (const Vec3& corner : triangles_[t].corner)
      low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  Node node{0.5 * (low + high), 0.0, first, last, 0, last - first <= kTrianglesOfLeaf};
  for (std::uint32_t t = first; t < last; ++t)
    for (const Vec3& corner : triangles_[t].corner)
      node.radius = std::max(node.radius, (corner - node.centre).norm());
  if (!node.leaf) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::uint32_t middle = (first + last) / 2;
    // Equal centroids are ordered by all their numbers, so that the order, and thus the sum, is the
    // same everywhere.
    const auto key = [axis](const ToolTriangle& c) {
      const Vec3 at = centroid(c.corner);
      return std::array{at[axis], at.x(), at.y(), at.z()};
    };
    std::stable_sort(triangles_.begin() + first, triangles_.begin() + last,
                     [&](const ToolTriangle& a, const ToolTriangle& b) { return key(a) < key(b); });
    build(first, middle);
    build(middle, last);
  }
  node.skip = static_cast<std::uint32_t>(nodes_.size());
  nodes_[here] = node;
}

}  // namespace voxtouch::reference
