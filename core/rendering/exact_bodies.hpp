#pragma once
/// The meshes of a scene for the virtual tool on triangles (core/exact).
#include <cstddef>
#include <span>
#include <vector>

#include "core/exact/bodies.hpp"
#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::rendering {

/// Bodies in a local frame: x' = scale (x - origin) with x in W; for the tool x' = scale x with x
/// in T. The origin is near the objects, and every tool has about the same size in x'. Results are
/// therefore bit-identical for any position and size of a scene. Immutable.
class ExactBodies {
 public:
  /// A resting mesh in W, and the objects of the scene that its triangles belong to.
  struct Object {
    mesh::TriangleMesh mesh;
    std::vector<std::size_t> objects;   ///< object numbers, indexed by owner
    std::vector<std::uint32_t> owners;  ///< of each triangle; empty: all belong to the first
  };

  /// `edge_m`: voxel edge of the scene; origins are at its multiples. Orients closed parts outward.
  /// Throws std::invalid_argument if the tool is a point at its origin, or if a mesh has no
  /// triangle with an area. Allocates.
  ExactBodies(const mesh::TriangleMesh& tool, std::span<const Object> objects, double edge_m);

  double scale() const noexcept { return scale_; }
  const Vec3& origin() const noexcept { return origin_; }
  const exact::ToolBody& tool() const noexcept { return tool_; }
  std::span<const exact::ObjectBody> bodies() const noexcept { return bodies_; }
  /// Number of the object of body `n`'s first triangle. All objects of a body have the same motion.
  std::size_t leader(std::size_t n) const noexcept { return leaders_[n]; }
  /// Object numbers, indexed by owner: those of the first body, then those of the next.
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
