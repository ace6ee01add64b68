#pragma once
/// The meshes of a scene as the virtual tool on triangles (core/exact) meets them.
#include <cstddef>
#include <span>
#include <vector>

#include "core/exact/bodies.hpp"
#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::rendering {

/// Bodies are built in a frame of their own: x' = scale (x - origin) with x in W; of the tool
/// x' = scale x with x in T. So neither the place of a scene nor its size changes a bit of what is
/// found: the origin is near the objects, and in x' any tool is about as large. Immutable.
class ExactBodies {
 public:
  /// A mesh in W at rest, and which objects of the scene its triangles belong to.
  struct Object {
    mesh::TriangleMesh mesh;
    std::vector<std::size_t> objects;   ///< numbers of objects, by owner
    std::vector<std::uint32_t> owners;  ///< of each triangle; empty: all are of the first
  };

  /// `edge_m`: the voxel edge of the scene; origins lie at its multiples. Closed parts are turned
  /// outward. Throws std::invalid_argument where the tool is a point at its origin, or a mesh has
  /// no triangle with an area. Allocates.
  ExactBodies(const mesh::TriangleMesh& tool, std::span<const Object> objects, double edge_m);

  double scale() const noexcept { return scale_; }
  const Vec3& origin() const noexcept { return origin_; }
  const exact::ToolBody& tool() const noexcept { return tool_; }
  std::span<const exact::ObjectBody> bodies() const noexcept { return bodies_; }
  /// Number of the object that lent body `n` its first triangle: all its objects move alike.
  std::size_t leader(std::size_t n) const noexcept { return leaders_[n]; }
  /// Numbers of objects, by owner: those of the first body, then those of the next.
  std::span<const std::size_t> objects() const noexcept { return objects_; }
  std::size_t bytes() const noexcept;

 private:
  double scale_;
  Vec3 origin_;
  exact::ToolBody tool_;
  std::vector<exact::ObjectBody> bodies_;
  std::vector<std::size_t> leaders_, objects_;
};

}  // namespace voxtouch::rendering
