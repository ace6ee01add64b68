#pragma once
/// The stage that follows the contact model in the ring: it remembers the last frame, which the
/// models may not.
#include <cstdint>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/push_sums.hpp"

namespace voxtouch::contact {

/// One frame of the ring.
struct StageResult {
  ContactResult
      contact;  ///< the model's result, with blended directions and the retained points' push added
  bool latched = false;  ///< points have gone through (or just came back): remembered depths push
  bool fast = false;     ///< some point may have moved more than half a voxel since the last pose
  bool tunnelling_suspected = false;  ///< ContactRenderer: so fast next to the scene that something
                                      ///< may have been passed unseen
  bool passed_through = false;  ///< ContactRenderer, of a model alone: the tool's middle is in what
                                ///< it touches, and nothing holds it from passing
};

/// How a stage is set up.
struct StageConfig {
  std::size_t points = 0;  ///< size of the shell
  double reach_m = 0.0;    ///< largest distance of a shell point from the tool's origin
  double edge_m = 0.0;     ///< voxel edge e of the static grid
  double stiffness = 0.0;  ///< K of a weight of one, as ContactParameters
  ContactModelKind model = ContactModelKind::kAdapted;
  bool memoryless = false;  ///< as ContactParameters: nothing but the fast flag
};

/// Whether the stage keeps a depth for each point: for the contact models that know none beyond the
/// surface layer.
constexpr bool remembers(ContactModelKind model) noexcept {
  return model == ContactModelKind::kOriginal || model == ContactModelKind::kAdapted;
}

/// Blends directions (`adapted` only), retains depths of points that have gone through, and sets
/// the fast flag; formulas in laws.md.
///
/// Where nothing is retained, and directions are not blended, this costs a copy of the points'
/// numbers and nothing else a point. `field`, and any model that is to be alone, passes through
/// with the fast flag only: `field` has neither a fallback to blend nor a layer to go through.
///
/// All memory is taken at construction; `apply` and `reset` are real-time safe. Not safe to share
/// between threads.
class ContactStage {
 public:
  /// Takes all memory for a shell of `config.points` points. Allocates.
  explicit ContactStage(const StageConfig& config);

  /// `plain` is what the model gave for `hits`. A pose that could not be looked up passes through
  /// and leaves the memory alone.
  StageResult apply(const HitList& hits, const ContactResult& plain) noexcept {
    return apply(hits, plain,
                 hits.pose_status == PoseStatus::kUsable ? motion_to(hits.pose_WT) : 0.0);
  }
  /// The same with what `motion_to(hits.pose_WT)` gave.
  StageResult apply(const HitList& hits, const ContactResult& plain, double moved_m) noexcept;

  /// Bound of every point's path from the last pose to `pose` [m]; 0 where there is no last pose.
  /// Real-time safe.
  double motion_to(const Pose& pose) const noexcept {
    return has_last_pose_ ? motion_bound(pose) : 0.0;
  }

  /// For the members of one solid, whose voxels are different ones of one grid: a point that went
  /// from one to the next is remembered. Each adds the others' memory to the first one's, and takes
  /// that. Once a frame at most, before `apply`. Real-time safe.
  void merge_memory(const ContactStage& other) noexcept;
  void copy_memory(const ContactStage& other) noexcept;

  /// Forgets everything, also the last pose.
  void reset() noexcept;

 private:
  enum class Push : std::uint8_t { kShared, kOwn };  ///< retained, along g; along the own normal
  /// A point whose remembered depth pushes.
  struct LatchedHit {
    std::uint32_t point = 0;
    Push push = Push::kOwn;
    double depth_m = 0.0;
  };
  struct Frame;

  bool works() const noexcept { return remembers(config_.model) && !config_.memoryless; }
  double motion_bound(const Pose& pose) const noexcept;
  void update_shared_direction(const HitList& hits) noexcept;
  double plain_depth(const Hit& hit, const PushDirection& direction) const noexcept;
  Vec3 latched_direction(Push push, const Hit& hit) const noexcept;
  Push choose_direction(const HitList& hits, const Hit& hit) const noexcept;
  void surface_points(const HitList& hits, Frame& frame, StageResult& result) const noexcept;
  void returning_point(const HitList& hits, const Hit& hit, const LatchedHit& before, Frame& frame,
                       StageResult& result) noexcept;
  void latched_points(const HitList& hits, Frame& frame, StageResult& result) noexcept;
  LatchedHit gone_through(const HitList& hits, const Hit& hit) const noexcept;
  void push_latched(const HitBlock& block, std::size_t first, Pushes& pushes,
                    PushLanes& lanes) const noexcept;
  void push(const HitList& hits, const Hit& hit, double depth, const Vec3& direction,
            ContactResult& result) const noexcept;
  void count_latched(Push push, const Hit& hit, Frame& frame, ContactResult& result) const noexcept;

  StageConfig config_;
  // Of the last frame: the points in the surface layer, whose depths are worked out only should
  // they go through, with the direction they pushed along; and those that were retained, ascending.
  Hits last_surface_;
  PushDirection last_direction_;
  std::vector<LatchedHit> latched_;
  std::vector<LatchedHit> returning_, inside_;  ///< of the frame in work
  Pose last_pose_;
  bool has_last_pose_ = false;
  Vec3 shared_ = Vec3::Zero();       ///< last good direction; zero: none yet
  Vec3 shared_now_ = Vec3::Zero();   ///< g of this frame
  std::uint32_t shared_points_ = 0;  ///< points that pushed along g in the last frame
};

}  // namespace voxtouch::contact
