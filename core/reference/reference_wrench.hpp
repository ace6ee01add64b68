#pragma once
/// The true wrench of the law that all contact models approximate, as far as a mesh can be true.
#include <cstdint>
#include <memory>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// W axes; torque about the tool's origin. Per unit of the law's stiffness k = 1 N/m^3.
struct TrueWrench {
  Wrench wrench;                ///< [m^3], [m^4]
  double area_m2 = 0.0;         ///< of the tool's surface that lies inside the static object
  double depth_m = 0.0;         ///< of its deepest point that was looked at
  Vec3 deepest = Vec3::Zero();  ///< that point, W
  std::uint64_t samples = 0;    ///< signed distances asked for
};

/// The penalty law in the limit of ever finer points,
///
///   F = k  integral over the tool's surface inside the static object of  depth(x) n(x) dA, torque
///   likewise,
///
/// depth = minus the signed distance to the static triangles, n the tool's inward normal, of a
/// closed tool whichever way round its triangles run. By the divergence theorem it is the gradient
/// of the energy k times the integral of depth over the volume shared (the pressure law of a
/// liquid), so it is conservative, and a sphere of radius R at depth h in a half space feels k pi
/// h^2 (R - h / 3) along the normal.
///
/// The integral runs over the tool's own triangles, split where the depth bends
/// (depth_integral.hpp), with signed distances by the nearest feature (signed_surface.hpp). A part
/// of the tool whose centre is farther outside than it is wide is skipped: a distance changes by no
/// more than the displacement. Queries are const and may run at once; they allocate.
class ReferenceWrench {
 public:
  /// Reads the scene's mesh files itself. Throws std::runtime_error naming the file if one cannot
  /// be read, if the scene has no static mesh, or if a static mesh is open: it has no inside to be
  /// in. Several static meshes count as their union.
  ReferenceWrench(const scene::Scene& scene, double resolution_m);
  ~ReferenceWrench();

  /// A pose that is not finite gives zeros.
  TrueWrench at(const Pose& pose_WT) const;
  /// The same at another resolution.
  TrueWrench at(const Pose& pose_WT, double resolution_m) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace voxtouch::reference
