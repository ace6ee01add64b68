#pragma once
/// Scenes with a virtual tool, and a hand that moves in them.
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/contact/virtual_tool.hpp"
#include "core/mesh/triangle_mesh.hpp"
#include "core/pointshell/pointshell.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::virtual_tool {

inline constexpr double kStiffness = 300.0;  ///< [N/m]
inline constexpr double kPeriod = 1e-3;      ///< [s]
inline constexpr double kBall = 0.01;        ///< [m], radius of the ball that is usual

/// Edge of the voxels of the tool's distances over the scene's; 0: edges are not looked up.
inline double tool_ratio = 0.5;

/// The edges of a static mesh in `grid` as points, looked up in the tool. Stays where it is: the
/// query points into it.
struct EdgeLookup {
  test::Ground tool;
  contact::ContactQuery query;
  EdgeLookup(const mesh::TriangleMesh& fixed, const voxmap::Grid& grid,
             const mesh::TriangleMesh& tool);
  EdgeLookup(const EdgeLookup&) = delete;
  /// A ground with the edges too, unless `tool_ratio` says none.
  contact::ToolGround with(const contact::ToolGround& ground) const;
};

/// A static mesh and a tool in it. Stays where it is: the query points into it.
struct Rig {
  mesh::TriangleMesh mesh;
  test::Ground ground;
  contact::ContactQuery query;
  EdgeLookup edges;
  contact::VirtualTool tool;
  std::vector<contact::ToolGround> grounds;
  double edge;
  Rig(const mesh::TriangleMesh& mesh, double edge, const mesh::TriangleMesh& tool_mesh,
      double lever_m = 0.0);
  /// With another shell of the tool than `shell_of`.
  Rig(const mesh::TriangleMesh& mesh, double edge, const mesh::TriangleMesh& tool_mesh,
      const pointshell::Pointshell& shell, double lever_m = 0.0);
  Rig(const Rig&) = delete;

  contact::VirtualToolFrame frame(const Pose& hand, double friction = 0.0) {
    return tool.frame({hand, kPeriod, friction}, grounds);
  }
  contact::VirtualToolFrame frame(const Vec3& hand, const Quat& turn = Quat::Identity(),
                                  double friction = 0.0) {
    return frame(Pose{hand, turn}, friction);
  }
  /// Forgets the tool and places it anew, with the whole force. The caller sees to it that the pose
  /// is free.
  bool place(const Pose& at) { return tool.place(at, grounds); }
};

/// Edge of the voxels on which the tool's shell is made, over the scene's.
inline double shell_ratio = 1.0;
mesh::TriangleMesh ball_mesh(double radius_m = kBall);
pointshell::Pointshell ball_shell(double edge, double radius_m = kBall);
/// The shell of `mesh`, on a grid of `edge` times `shell_ratio`.
pointshell::Pointshell shell_of(const mesh::TriangleMesh& mesh, double edge);

/// "plane", "tilted", "cylinder", "cylinder:<sides>", "cup", "edge" (a block's right angle, askew),
/// "corner" (three walls that meet at the origin, along the grid), or "plate:<thickness in
/// m>[:askew]", at 0 an open sheet; "open:<shape>" is one of `open_shapes`.
mesh::TriangleMesh scene_mesh(const std::string& name);
/// Turn of what is tilted in `scene_mesh`.
Quat tilt();

double uniform(std::mt19937_64& random, double low, double high);
Vec3 random_direction(std::mt19937_64& random);

/// A point of the surface by area and its outward normal, of "open:" shapes either one; of "plane",
/// "tilted" and plates on the upper face, away from edges. Of "edge" a point of the edge and a
/// direction between its faces' normals, 5 degrees from either or more; of "corner" a way in from a
/// free place.
struct Place {
  Vec3 point, normal;
};
Place random_place(const std::string& scene, const mesh::TriangleMesh& mesh,
                   std::mt19937_64& random);

}  // namespace voxtouch::virtual_tool
