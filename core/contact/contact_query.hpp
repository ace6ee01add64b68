#pragma once
/// Finds the shell points in surface or interior voxels, culling parts of the shell that are far
/// from them.
#include "core/contact/contact_model.hpp"
#include "core/contact/sphere_tree.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::contact {

/// Owns the shell and its tree; the voxmap must outlive it. The constructor allocates, `find` does
/// not.
class ContactQuery {
 public:
  /// Throws std::invalid_argument if the arrays of the shell differ in length or contain non-finite
  /// numbers. Throws too if points are weighted by areas that are missing or negative.
  ContactQuery(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
               PointWeights weights = PointWeights::kOne);
  // Hits refer to the arrays of the shell, which a move does not relocate.
  ContactQuery(const ContactQuery&) = delete;
  ContactQuery(ContactQuery&&) = default;
  ContactQuery(voxmap::Voxmap&&, pointshell::Pointshell,
               PointWeights = PointWeights::kOne) = delete;

  /// Finds all hits at `pose_WT`, in the order of the shell, so that sums are bit-identical in
  /// every run. Real-time safe after `hits.reserve(shell().size())`.
  /// The arithmetic is local to the grid, whose origin is subtracted from the pose first. A scene
  /// at 1e6 m thus gives the same result as at 0. The quaternion is normalised. An invalid pose
  /// gives no hits and sets `hits.pose_status`.
  /// Single precision decides where it is certain, and double precision in a band next to the faces
  /// of the voxels (query_kernel.hpp). The set of hits is therefore exactly that of double
  /// precision, on every processor.
  void find(const Pose& pose_WT, HitList& hits) const noexcept;

  const pointshell::Pointshell& shell() const noexcept { return shell_; }
  const voxmap::Voxmap& voxmap() const noexcept { return voxmap_; }
  /// Memory of a query over that many points in addition to the shell itself.
  static std::size_t lookup_bytes(std::size_t points) noexcept {
    return SphereTree::bytes(points) + 4 * sizeof(float) * points;
  }
  const SphereTree& tree() const noexcept { return tree_; }
  /// Largest distance of a shell point from the tool's origin [m].
  double reach_m() const noexcept { return reach_m_; }

 private:
  const voxmap::Voxmap& voxmap_;
  pointshell::Pointshell shell_;
  std::vector<float> x_, y_, z_;  ///< the points in single precision, for a first decision
  std::vector<std::uint32_t>
      packed_normals_;  ///< packed normals; empty if they are not unit vectors
  SphereTree tree_;
  HitSource source_;  ///< the shell's part of the source
  double reach_m_ = 0.0;
};

}  // namespace voxtouch::contact
