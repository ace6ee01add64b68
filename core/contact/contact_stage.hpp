#pragma once
/// The stage after the contact model. It keeps state from frame to frame; the models do not.
#include <cstdint>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/penalty_sums.hpp"

namespace voxtouch::contact {

/// One frame of the ring.
struct StageResult {
  ContactResult contact;  ///< the model's result, with blended directions and the forces of latched
                          ///< points added
  /// Points have passed through (or just returned): latched depths give force.
  bool latched = false;
  bool fast = false;  ///< a point may have moved more than half a voxel since the last pose
  /// Set by ContactRenderer: fast near the scene, so a wall may have been passed undetected.
  bool tunnelling_suspected = false;
  /// Set by ContactRenderer if memoryless: the tool's centre is in an object, so it may pass.
  bool passed_through = false;
};

/// Configuration of a stage.
struct StageConfig {
  std::size_t points = 0;  ///< number of shell points
  double reach_m = 0.0;    ///< largest distance of a shell point from the tool's origin
  double edge_m = 0.0;     ///< voxel edge e of the static grid
  double stiffness = 0.0;  ///< K of ContactParameters [N/m, or N/m^3 for area weights]
  ContactModelKind model = ContactModelKind::kAdapted;
  bool memoryless = false;  ///< of ContactParameters: the stage sets only the fast flag
};

/// Whether the stage latches depths: for models without a depth below the surface layer.
constexpr bool remembers(ContactModelKind model) noexcept {
  return model == ContactModelKind::kOriginal || model == ContactModelKind::kAdapted;
}

/// Adds memory to a contact model: blends directions (`adapted` only), latches depths, and sets the
/// fast flag. Formulas are in laws.md.
///
/// `original` and `adapted` give no force to a point below the surface layer of voxels. The stage
/// therefore latches the depth that the point had in the layer, until it returns. Its force acts
/// along g, the last coherent mean normal of all points, or along the point's own normal. `field`
/// needs neither, so only its fast flag is set.
///
/// The constructor allocates all memory; `apply` and `reset` are real-time safe. One thread at a
/// time.
class ContactStage {
 public:
  /// Allocates all memory for a shell of `config.points` points.
  explicit ContactStage(const StageConfig& config);

  /// `plain` is the model's result for `hits`. For an invalid pose it is returned unchanged, and so
  /// is the memory.
  StageResult apply(const HitList& hits, const ContactResult& plain) noexcept {
    return apply(hits, plain,
                 hits.pose_status == PoseStatus::kUsable ? motion_to(hits.pose_WT) : 0.0);
  }
  /// The same with the result of `motion_to(hits.pose_WT)`.
  StageResult apply(const HitList& hits, const ContactResult& plain, double moved_m) noexcept;

  /// Bound of every point's path from the last pose to `pose` [m]; 0 without a last pose. Real-time
  /// safe.
  double motion_to(const Pose& pose) const noexcept {
    return has_last_pose_ ? motion_bound(pose) : 0.0;
  }

  /// Shares memory between the members of one solid (disjoint voxels of one grid), so that a point
  /// stays latched when it moves between them. Once per frame, before `apply`: merge the memory of
  /// each other member into the first, then copy that to the others. Real-time safe.
  void merge_memory(const ContactStage& other) noexcept;
  void copy_memory(const ContactStage& other) noexcept;

  /// Clears all state, including the last pose.
  void reset() noexcept;

 private:
  enum class Direction : std::uint8_t {
    kCommon,
    kOwnNormal
  };  ///< direction of a latched force: g, or the point's normal
  /// A point with a latched depth.
  struct LatchedHit {
    std::uint32_t point = 0;
    Direction direction = Direction::kOwnNormal;
    double depth_m = 0.0;
  };
  struct Frame;

  bool has_memory() const noexcept { return remembers(config_.model) && !config_.memoryless; }
  double motion_bound(const Pose& pose) const noexcept;
  void update_common_direction(const HitList& hits) noexcept;
  double surface_depth(const Hit& hit, const ForceDirection& direction) const noexcept;
  Vec3 latched_direction(Direction direction, const Hit& hit) const noexcept;
  Direction choose_direction(const HitList& hits, const Hit& hit) const noexcept;
  void surface_points(const HitList& hits, Frame& frame, StageResult& result) const noexcept;
  void returning_point(const HitList& hits, const Hit& hit, const LatchedHit& before, Frame& frame,
                       StageResult& result) noexcept;
  void latched_points(const HitList& hits, Frame& frame, StageResult& result) noexcept;
  LatchedHit latch(const HitList& hits, const Hit& hit) const noexcept;
  void add_latched_forces(const HitBlock& block, std::size_t first, PenaltyForces& forces,
                          PenaltyLanes& lanes) const noexcept;
  void add_force(const HitList& hits, const Hit& hit, double depth, const Vec3& direction,
                 ContactResult& result) const noexcept;
  void add_stiffness(Direction direction, const Hit& hit, Frame& frame,
                     ContactResult& result) const noexcept;

  StageConfig config_;
  // State of the last frame: the points in the surface layer with their force direction (depths are
  // computed only if they pass through), and the latched points, ascending.
  Hits last_surface_;
  ForceDirection last_direction_;
  std::vector<LatchedHit> latched_;
  std::vector<LatchedHit> returning_, inside_;  ///< of the present frame
  Pose last_pose_;
  bool has_last_pose_ = false;
  Vec3 common_ = Vec3::Zero();       ///< last coherent mean normal; zero: none so far
  Vec3 common_now_ = Vec3::Zero();   ///< g of this frame
  std::uint32_t common_points_ = 0;  ///< number of points with force along g in the last frame
};

}  // namespace voxtouch::contact
