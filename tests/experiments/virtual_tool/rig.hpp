#pragma once
/// Scenes with a virtual tool, and a hand that moves in them.
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/rendering/exact_tool.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::virtual_tool {

inline constexpr double kStiffness = 300.0;  ///< [N/m]
inline constexpr double kPeriod = 1e-3;      ///< [s]
inline constexpr double kBall = 0.01;        ///< [m], radius of the ball that is usual

/// A static mesh and a tool in it, as in a scene. Not movable: the tool refers to it.
struct Rig {
  mesh::TriangleMesh mesh;
  rendering::ExactBodies bodies;
  rendering::ExactTool tool;
  Vec3 displacement = Vec3::Zero();  ///< of the static mesh
  double lever_m;
  /// `edge_m`: the scene's voxel size, which no result depends on; `lever_m` 0: the tool's reach.
  Rig(const mesh::TriangleMesh& mesh, double edge_m, const mesh::TriangleMesh& tool_mesh,
      double lever_m = 0.0);
  Rig(const Rig&) = delete;

  exact::VirtualToolFrame frame(const Pose& hand, double friction = 0.0) {
    return tool.frame({hand, kPeriod, friction}, {&displacement, 1});
  }
  exact::VirtualToolFrame frame(const Vec3& hand, const Quat& turn = Quat::Identity(),
                                double friction = 0.0) {
    return frame(Pose{hand, turn}, friction);
  }
  /// Resets the tool and places it, with the full force. False if `at` is not a valid start.
  bool place(const Pose& at);
};

/// Whether `x` is inside the closed parts of a mesh, by the angles of all triangles.
bool inside(const mesh::TriangleMesh& mesh, const Vec3& x);

mesh::TriangleMesh ball_mesh(double radius_m = kBall);
pointshell::Pointshell ball_shell(double edge, double radius_m = kBall);

/// "plane", "tilted", "cylinder", "cylinder:<sides>", "cup", "edge" (a block's right angle, askew),
/// "corner" (three walls that meet at the origin, along the grid), or "plate:<thickness in
/// m>[:askew]", at 0 an open sheet; "open:<shape>" is one of `open_shapes`.
mesh::TriangleMesh scene_mesh(const std::string& name);
/// Rotation of tilted shapes in `scene_mesh`.
Quat tilt();

double uniform(std::mt19937_64& random, double low, double high);
Vec3 random_direction(std::mt19937_64& random);

/// A point of the surface by area and its outward normal; either normal for "open:" shapes. On
/// "plane", "tilted" and plates it is on the upper face, away from edges. On "edge" it is a point
/// of the edge and a direction between its faces' normals, at least 5 degrees from either. On
/// "corner" it is a direction from a free place.
struct Place {
  Vec3 point, normal;
};
Place random_place(const std::string& scene, const mesh::TriangleMesh& mesh,
                   std::mt19937_64& random);

}  // namespace voxtouch::virtual_tool
