#pragma once
/// Detects on the triangles that a virtual tool has passed a wall that is too thin to hold it.
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/types/geometry.hpp"
#include "core/voxmap/distance_tree.hpp"
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::rendering {

/// Points inside the tool, and the triangles of resting objects. It must not move.
class WallWatch {
 public:
  static constexpr std::size_t kMostPoints = 24;

  /// `inside_m`: depth of the points below the shell. Throws std::runtime_error for a mesh that is
  /// not finite.
  WallWatch(mesh::TriangleMesh walls, const pointshell::Pointshell& shell, double inside_m);
  WallWatch(const WallWatch&) = delete;
  WallWatch& operator=(const WallWatch&) = delete;

  /// Whether one of the points crosses a triangle on its straight path from `from` to `to`.
  /// Real-time safe.
  bool passed(const Pose& from, const Pose& to) const noexcept;

 private:
  bool crosses(const Vec3& from, const Vec3& to) const noexcept;

  mesh::TriangleMesh walls_;
  voxmap::GridMesh mesh_;
  voxmap::DistanceTree tree_;
  std::vector<Vec3> points_;  ///< in T
};

}  // namespace voxtouch::rendering
