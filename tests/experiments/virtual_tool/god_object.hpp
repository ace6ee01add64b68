#pragma once
/// The truth for a ball: the exact ball that stays outside exact triangles and is drawn to the hand
/// (Zilles and Salisbury 1995).
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::virtual_tool {

/// Has no code or data in common with the virtual tool: it computes the nearest point of every near
/// triangle.
class GodObject {
 public:
  GodObject(const mesh::TriangleMesh& mesh, double radius_m) : mesh_(mesh), radius_m_(radius_m) {}

  /// Distance from `x` to the nearest triangle [m], unsigned.
  double distance(const Vec3& x) const;
  /// Sets the ball's centre; the caller ensures that the ball is outside. Only triangles within
  /// `range_m` are used afterwards.
  void place(const Vec3& centre, double range_m);
  /// Draws the ball to `hand` in steps too short to pass a wall. \returns its centre.
  const Vec3& draw_to(const Vec3& hand);

 private:
  const mesh::TriangleMesh& mesh_;
  double radius_m_;
  Vec3 centre_ = Vec3::Zero();
  std::vector<std::size_t> near_;
};

}  // namespace voxtouch::virtual_tool
