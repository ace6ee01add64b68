#pragma once
/// A virtual tool on triangles with one object, led by a hand.
#include <numbers>

#include "core/exact/virtual_tool.hpp"
#include "tests/support/exact_shapes/shapes.hpp"

namespace voxtouch::exact {

inline constexpr double kDegree = std::numbers::pi / 180.0;

inline Quat turned(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

/// Angle between two directions [rad].
inline double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

struct Rig {
  Rig(const mesh::TriangleMesh& tool_mesh, const mesh::TriangleMesh& object_mesh,
      VirtualToolOptions options = {})
      : tool(tool_mesh),
        object(object_mesh),
        bodies{&object},
        virtual_tool(tool, bodies, options),
        posed(tool.features().points) {}

  VirtualToolFrame frame(const Pose& hand, double friction = 0.0) {
    return virtual_tool.frame({hand, 1e-3, friction}, {&object_pose, 1});
  }
  /// The hand stays; the last of `frames`.
  VirtualToolFrame rest(const Pose& hand, int frames) {
    VirtualToolFrame last;
    for (int k = 0; k < frames; ++k)
      last = frame(hand);
    return last;
  }
  /// Moves the hand there in equal steps.
  VirtualToolFrame lead(const Pose& from, const Pose& to, int frames) {
    VirtualToolFrame last;
    for (int k = 1; k <= frames; ++k) {
      const double part = static_cast<double>(k) / frames;
      last = frame({from.position + part * (to.position - from.position),
                    from.orientation.slerp(part, to.orientation)});
    }
    return last;
  }
  /// Brute force: edges of each against faces of the other, at the tool's pose.
  bool intersects() {
    posed.set_pose(object_pose.inverse() * virtual_tool.pose());
    return intersect(tool, object, posed);
  }

  ToolBody tool;
  ObjectBody object;
  std::array<const ObjectBody*, 1> bodies;
  VirtualTool virtual_tool;
  Pose object_pose;
  PosedPoints posed;
};

}  // namespace voxtouch::exact
