#pragma once
/// ContactCase 3, `clustered`: the paper's mean normal taken for each patch instead of over all points, points weighed by their area, and
/// voxel planes blended between neighbouring voxels.
#include <vector>

#include "core/contact/blended_plane.hpp"
#include "core/contact/contact_model.hpp"

namespace voxtouch::contact {

/// Over all hits i, in surface and in interior voxels, with area A_i, inward normal n_i, blended plane P_i:
///
///   s_i = depth of P_i along n_i (signed, from the layer's middle)
///   m_i = mean normal of the patch that n_i lies in, each point weighed by A_j f_j max(0, s_j + e/2)   (PatchNormals)
///   d_i = f_i max(0, depth of P_i along m_i),  f_i the fade at the border to free voxels
///   F   = k sum A_i d_i (n_i . m_i) m_i                          torque = k sum A_i d_i arm_i x n_i
///
/// So each point pushes along its own normal as hard as its patch is deep, and of that push the part along the patch's mean is
/// kept: what is left of it across the patch is noise of the sampling. The torque is the push's own, which on a sphere is
/// none. Weights that grow with the depth from half an edge above the layer's middle let points join and leave a mean
/// without a step; walls whose normals are far apart do not share a mean, so that in a corner each pushes as if alone and
/// in a slot they cancel.
///
/// Nothing is remembered and nothing jumps: all parts are continuous in the pose, also where a point comes, goes, passes a voxel's border or goes through
/// into the interior, where d_i ends at contact_limits::kDeepEdges e and `saturated` is set. A push does not grow from
/// there on with a point's depth, but more points come; wholly inside a body the pushes cancel.
///
/// What it cannot do: tell where within its voxels a surface lies that runs along the grid. The layer's middle is taken for
/// it, which is half an edge off at most. Since the force grows with the square of a round tool's depth, its size then
/// varies more than the paper's (about 100 % against 40 % on a cylinder, half an edge deep); on oblique faces it varies less.
/// A wall thinner than two edges is one layer: what touches it feels nothing until past the middle of the wall.
///
/// `mean_normal` and `coherence` are weighed by area over all hits; there is no fallback.
class ClusteredModel final : public ContactModel {
 public:
  /// `points`: of the shell; scratch memory for as many is taken here. One thread at a time.
  ClusteredModel(const voxmap::Voxmap& voxmap, std::size_t points, double stiffness);
  ContactModelKind kind() const noexcept override { return ContactModelKind::kClustered; }
  void evaluate(const HitList& hits, ContactResult& result) const noexcept override;

 private:
  void look_up(const HitList& hits) const noexcept;

  const voxmap::Voxmap& voxmap_;
  double stiffness_;
  mutable std::vector<BlendedPlane> planes_;  ///< of this frame's hits, surface first: each is asked for twice
};

/// Throws std::invalid_argument for points that do not weigh by area and where the voxmap is missing.
std::unique_ptr<ContactModel> make_clustered_model(const ContactParameters& parameters, const ContactGround& ground);

}  // namespace voxtouch::contact
