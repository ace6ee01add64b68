#pragma once
/// Reference for a virtual tool of any shape: the tool's triangles stay outside the scene's
/// triangles and are pulled to the hand.
#include <memory>
#include <optional>

#include "core/reference/reference_mesh.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// The tool at its end, or at the last step if none was found. All in W.
struct GodObjectRest {
  Pose tool;
  Vec3 shift = Vec3::Zero();     ///< from the tool to the hand [m]
  Vec3 rotation = Vec3::Zero();  ///< rotation vector [rad], from the tool to the hand
  double lever_m = 0.0;
  int steps = 0;
  bool settled = false;  ///< no step brings it nearer to the hand
  double apart_m = 0.0;  ///< distance of the surfaces by FCL; 0: they meet

  /// Of a spring of 1 N/m on the hand, the torque about the tool's origin.
  Wrench wrench() const { return {-shift, -(lever_m * lever_m) * rotation}; }
};

/// With d = [hand - tool; lever * rotation vector from tool to hand], the tool moves to a local
/// minimum of |d|^2 / 2 over the poses at which the meshes do not intersect (Zilles and Salisbury
/// 1995, for six degrees of freedom; Ortega et al. 2007). Quasi-static, without friction.
///
/// A step is the remainder of d after projection on inequalities. Each comes from the first meeting
/// of two parts of the meshes along the step; the projection is repeated until nothing meets. Parts
/// are convex, so for a translation the plane between them at their meeting keeps them apart. A
/// rotation bends the path; then the step is cut and repeated.
///
/// Shares no code with the virtual tool. Milliseconds to seconds per call, depending on the number
/// of triangles near the contact. Allocates.
class GodObject {
 public:
  /// `tool` in T and closed, `scene` in W: the union of all objects at rest, open or closed.
  /// `lever_m` 0: the tool's reach. Throws std::invalid_argument for an open tool.
  GodObject(const ReferenceMesh& tool, const ReferenceMesh& scene, double lever_m = 0.0);
  ~GodObject();

  /// The tool starts at `from`, outside, and the hand leads it on a straight path to `hand`. None
  /// if the tool touches the scene at `from`.
  std::optional<GodObjectRest> led(const Pose& from, const Pose& hand);
  /// The same for a hand that is at `hand` from the first step on.
  std::optional<GodObjectRest> pulled(const Pose& from, const Pose& hand);

  double lever_m() const noexcept;
  double tool_reach_m() const noexcept;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

/// All meshes as one, each vertex posed. Not welded across meshes. Throws std::invalid_argument for
/// no mesh.
ReferenceMesh joined_mesh(const std::vector<std::pair<ReferenceMesh, Pose>>& meshes);

}  // namespace voxtouch::reference
