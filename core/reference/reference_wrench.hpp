#pragma once
/// Reference wrench of the law that all contact models approximate, up to the accuracy of the mesh.
#include <cstdint>
#include <memory>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::reference {

/// W axes; torque about the tool's origin. For stiffness k = 1 N/m^3.
struct TrueWrench {
  Wrench wrench;                ///< [m^3], [m^4]
  double area_m2 = 0.0;         ///< of the tool's surface inside the static object
  double depth_m = 0.0;         ///< of the deepest evaluated point
  Vec3 deepest = Vec3::Zero();  ///< that point, W
  std::uint64_t samples = 0;    ///< number of signed distances computed
};

/// The penalty law in the limit of infinitely many points,
///
///     F = k integral over the tool's surface inside the static object of depth(x) n(x) dA
///
/// with the corresponding torque. The depth is minus the signed distance to the static triangles, n
/// the inward normal of the closed tool, for either orientation of its triangles. By the divergence
/// theorem, F is the gradient of the energy k times the integral of depth over the shared volume
/// (the pressure law of a liquid). It is therefore conservative. A sphere of radius R at depth h in
/// a half space receives the force k pi h^2 (R - h / 3) along the normal.
///
/// The integral covers the tool's own triangles, split where the depth is nonlinear
/// (depth_integral.hpp), with signed distances by the nearest feature (signed_surface.hpp). A part
/// whose centre is farther outside than its extent is skipped, since a distance changes by at most
/// the displacement. Queries are const and may run concurrently; they allocate.
class ReferenceWrench {
 public:
  /// Reads the scene's mesh files itself. Throws std::runtime_error naming the file if one is
  /// unreadable, if the scene has no static mesh, or if a static mesh is open and so has no
  /// interior. Several static meshes count as their union.
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
