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
  bool retained = false;  ///< points have gone through (or just came back): remembered depths push
  bool fast = false;      ///< some point may have moved more than half a voxel since the last pose
  bool missed = false;   ///< ContactRenderer: so fast beside the scene that something may have been
                         ///< passed unseen
  bool passing = false;  ///< ContactRenderer, of a model alone: the tool's middle is in what it
                         ///< touches, and nothing holds it from passing
};

/// How a stage is set up.
struct StageConfig {
  std::size_t points = 0;  ///< size of the shell
  double reach_m = 0.0;    ///< largest distance of a shell point from the tool's origin
  double edge_m = 0.0;     ///< voxel edge e of the static grid
  double stiffness = 0.0;  ///< K of a weight of one, as ContactParameters
  ContactModelKind model = ContactModelKind::kAdapted;
  bool alone = false;  ///< as ContactParameters: nothing but the fast flag
  /// Of a shell in levels, which may leave out points: who stands for each
  /// (pointshell::ShellLevels::stands_in). Must outlive the stage; null: none is left out.
  const std::uint32_t* stands_in = nullptr;
};

/// Whether the stage keeps a depth for each point: for the contact models that know none beyond the
/// surface layer.
constexpr bool remembers(ContactModelKind model) noexcept {
  return model == ContactModelKind::kOriginal || model == ContactModelKind::kAdapted;
}

/// Blend, retain, and the fast flag. Let rho = |sum_S w_i n_i| / sum_S w_i, m the mean normal, s =
/// smoothstep(rho; 0.2, 0.5).
///
/// Blend (`adapted` only). A surface point pushes along u_i = s m + (1 - s) n_i, brought to unit
/// length, with its depth along u_i. s = 1 gives the model's own bits, s = 0 those of `original`.
/// Where u_i all but vanishes (n_i = -m at s = 1/2) it is divided by 0.1 instead of its length: the
/// point's push fades through zero, never 0/0, and F stays continuous in rho, n_i.
///
/// Retain. Each point remembers the depth it last pushed with. In an interior voxel it goes on
/// pushing with that depth (at least e/4); one that was in no surface voxel the frame before pushes
/// with e along its own normal, or, where a budget had left it out, as the one that stood for it.
/// The direction is chosen when the point goes through: the shared retained direction g or the
/// point's own normal. g is the last coherent mean normal of all points in contact, those gone
/// through included, while there are surface hits (without any gone through: m). It follows the
/// present mean as far as that is coherent and agrees with g: round a curved wall it turns, beyond
/// the tool's equator it does not turn over. A point whose own normal opposes g and that moved
/// along g to get inside (the far wall of a slot) takes its own normal, since g would push it
/// deeper.
///
/// Way back. A point that returns to the surface layer pushes with max(plain depth, remembered
/// depth), and the remembered depth shrinks by 1 m for each metre the tool moved (the bound used
/// for `fast`). So a returning point weakens its push by at most K w_i times that way (and by the
/// turn from g to u_i), and strengthens it by at most K w_i sqrt(3)/2 e, which is the step of the
/// plain law at any voxel border. A point that reaches free space forgets; without any contact the
/// stage forgets all.
///
/// Where nothing is retained, and directions are not blended, this costs a copy of the points'
/// numbers and nothing else a point.
///
/// `field`, and any model that is to be alone, passes through with the fast flag only: `field` has
/// neither a fallback to blend nor a layer to go through.
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

  /// Bound of every point's way from the last pose to `pose` [m]; 0 where there is no last pose.
  /// Real-time safe.
  double motion_to(const Pose& pose) const noexcept {
    return has_last_pose_ ? motion_bound(pose) : 0.0;
  }

  /// Forgets everything, also the last pose.
  void reset() noexcept;

 private:
  enum class Push : std::uint8_t { kShared, kOwn };  ///< retained, along g; along the own normal
  /// A point whose remembered depth pushes.
  struct RetainedHit {
    std::uint32_t point = 0;
    Push push = Push::kOwn;
    double depth_m = 0.0;
  };
  struct Frame;

  bool works() const noexcept { return remembers(config_.model) && !config_.alone; }
  double motion_bound(const Pose& pose) const noexcept;
  void update_shared_direction(const HitList& hits) noexcept;
  double plain_depth(const Hit& hit, const PushDirection& direction) const noexcept;
  Vec3 retained_direction(Push push, const Hit& hit) const noexcept;
  Push choose_direction(const HitList& hits, const Hit& hit) const noexcept;
  void surface_points(const HitList& hits, Frame& frame, StageResult& result) const noexcept;
  void returning_point(const HitList& hits, const Hit& hit, const RetainedHit& before, Frame& frame,
                       StageResult& result) noexcept;
  void held_points(const HitList& hits, Frame& frame, StageResult& result) noexcept;
  RetainedHit gone_through(const HitList& hits, const Hit& hit) const noexcept;
  void push_held(const HitBlock& block, std::size_t first, Pushes& pushes,
                 PushLanes& lanes) const noexcept;
  void push(const HitList& hits, const Hit& hit, double depth, const Vec3& direction,
            ContactResult& result) const noexcept;
  void count_retained(Push push, const Hit& hit, Frame& frame,
                      ContactResult& result) const noexcept;

  StageConfig config_;
  // Of the last frame: the points in the surface layer, whose depths are worked out only should
  // they go through, with the direction they pushed along; and those that were retained, ascending.
  Hits last_surface_;
  PushDirection last_direction_;
  std::vector<RetainedHit> retained_;
  std::vector<RetainedHit> returning_, inside_;  ///< of the frame in work
  std::uint32_t last_asked_end_ = 0xffffffff;    ///< HitList::asked_end
  Pose last_pose_;
  bool has_last_pose_ = false;
  Vec3 shared_ = Vec3::Zero();       ///< last good direction; zero: none yet
  Vec3 shared_now_ = Vec3::Zero();   ///< g of this frame
  std::uint32_t shared_points_ = 0;  ///< points that pushed along g in the last frame
};

}  // namespace voxtouch::contact
