#pragma once
/// The dynamic object without a declared sphere: a mesh against meshes, within the limits of the
/// method.
#include <vector>

#include "core/reference/gap.hpp"
#include "core/reference/posed_mesh.hpp"

namespace voxtouch::reference {

class DynamicMesh {
 public:
  /// Reads the mesh. Throws as PosedMesh.
  explicit DynamicMesh(const scene::MeshSpec& spec);

  /// Gap against the union of `statics`, at least one, with the tool at `pose_WT`.
  GapResult gap(const std::vector<PosedMesh>& statics, const Pose& pose_WT) const;

  /// Distance between its surface and that of the nearest of `statics` [m]; 0 if they meet. By FCL
  /// alone, without a second method; does not detect an object completely inside the other.
  double apart_m(const std::vector<PosedMesh>& statics, const Pose& pose_WT) const;

 private:
  GapResult against(const PosedMesh& object, const Pose& pose_WT) const;
  bool one_encloses_other(const PosedMesh& object, const Pose& pose_OM) const;
  GapResult overlap(const PosedMesh& object, const Pose& pose_WM, double surfaces_apart_m) const;

  /// Calls `visit(index)` for the objects that may be nearest; see visit_nearest_first.
  template <class Visit>
  void visit_near(const std::vector<PosedMesh>& statics, const Pose& pose_WT, Visit visit) const {
    visit_nearest_first(statics, pose_WT * (body_.pose() * centre_), radius_m_, visit);
  }

  PosedMesh body_;              ///< with the mesh's pose in T
  Vec3 centre_ = Vec3::Zero();  ///< of an enclosing ball, in the mesh's frame
  double radius_m_ = 0.0;
};

}  // namespace voxtouch::reference
