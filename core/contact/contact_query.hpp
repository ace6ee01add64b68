#pragma once
/// Finds the shell points that lie in surface or interior voxels, culling whole parts of the shell
/// that are far from them.
#include "core/contact/contact_model.hpp"
#include "core/contact/sphere_tree.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::contact {

/// Holds the shell and its tree; the voxmap must outlive it. Construction allocates; `find` does
/// not.
class ContactQuery {
 public:
  /// Throws std::invalid_argument where the shell's arrays differ in length or hold a number that
  /// is not finite, or where points are to be weighed by areas that are missing or negative.
  ContactQuery(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
               PointWeights weights = PointWeights::kOne);
  ContactQuery(const ContactQuery&) =
      delete;  // hits point into the shell's arrays, which stay where they are when it is moved
  ContactQuery(ContactQuery&&) = default;
  ContactQuery(voxmap::Voxmap&&, pointshell::Pointshell,
               PointWeights = PointWeights::kOne) = delete;

  /// All hits at `pose_WT`, in a fixed order (the shell's), so that sums give bit-identical results
  /// on every run. Arithmetic is local to the grid: the grid's origin is taken off the pose first,
  /// so a scene at 1e6 m gives what it gives at 0. The quaternion is brought to unit norm. A pose
  /// that cannot be looked up gives no hits and says so in `hits.pose_status`. Real-time safe once
  /// `hits.reserve(shell().size())` has been called.
  ///
  /// Single precision decides where it is certain, doubles in a band next to the voxels' faces
  /// (query_kernel.hpp): which points hit is what doubles alone would say, to the last bit of the
  /// pose, on every processor.
  void find(const Pose& pose_WT, HitList& hits) const noexcept;

  const pointshell::Pointshell& shell() const noexcept { return shell_; }
  const voxmap::Voxmap& voxmap() const noexcept { return voxmap_; }
  /// What a query over that many points takes in addition to the shell itself.
  static std::size_t lookup_bytes(std::size_t points) noexcept {
    return SphereTree::bytes(points) + 4 * sizeof(float) * points;
  }
  const SphereTree& tree() const noexcept { return tree_; }
  /// Largest distance of a shell point from the tool's origin [m].
  double reach_m() const noexcept { return reach_m_; }

 private:
  const voxmap::Voxmap& voxmap_;
  pointshell::Pointshell shell_;
  std::vector<float> x_, y_, z_;  ///< the points once more, for what is decided in single precision
  std::vector<std::uint32_t>
      packed_normals_;  ///< likewise their normals; none: they are not of unit length
  SphereTree tree_;
  HitSource source_;  ///< the shell's part of it
  double reach_m_ = 0.0;
};

}  // namespace voxtouch::contact
