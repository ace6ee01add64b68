#pragma once
/// The whole way from a pose to a wrench behind one class: query, model, stage.
#include <memory>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/contact_stage.hpp"
#include "core/contact/limits.hpp"
#include "core/contact/motion_path.hpp"

namespace voxtouch::contact {

/// A time budget as counts.
struct FrameBudget {
  /// Points that a frame may test at most, over all of its look-ups; 0: any number, and no levels.
  std::uint32_t points = 0;
  pointshell::ShellLevels levels = {};  ///< of the shell; none: the shell has so few points that nothing is ever left out

  /// Most look-ups of a frame: where the tool is, and the sub-poses of fast motion with both of their ends.
  static constexpr std::uint32_t kLookups = limits::kMaxSubPoses + 2;
  /// What the coarsest level may have at most, so that a look-up of a fast frame has room for all of it and for as many leaves of contacts.
  static constexpr std::uint32_t coarsest_of(std::uint32_t points) noexcept {
    constexpr std::uint32_t kShares = kLookups * (SphereTree::kLeafPoints + 1);
    return points / kShares < SphereTree::kLeafPoints ? SphereTree::kLeafPoints : points / kShares;
  }
  /// The least with which nothing that this promises is lost.
  static constexpr std::uint32_t kMinPoints = SphereTree::kLeafPoints * kLookups * (SphereTree::kLeafPoints + 1);
};

/// What a rendering node holds for one tool in one scene. The voxmap must outlive it. One thread at a time: `render` and
/// `probe` share the list of hits.
class ContactRenderer {
 public:
  /// `field` is looked up by the model of that name only, and must outlive the renderer too. Throws std::invalid_argument for
  /// a model that does not exist or lacks its field, a stiffness or a shell that cannot be used.
  ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell, ContactModelKind model, const ContactParameters& parameters,
                  const voxmap::DistanceField* field = nullptr, FrameBudget budget = {});
  ContactRenderer(voxmap::Voxmap&&, pointshell::Pointshell, ContactModelKind, const ContactParameters&,
                  const voxmap::DistanceField* = nullptr, FrameBudget = {}) = delete;

  /// One frame of the ring, `pose_WT` = T in W. Real-time safe. A pose that cannot be looked up gives a zero wrench and
  /// the reason in `contact.pose_status`, and leaves the stage as it was.
  ///
  /// Fast motion. Where some point may have moved more than e/2 since the last frame, the straight way (screw: slerp) is walked in
  /// sub-poses e/2 apart, at most kMaxSubPoses of them, so that the stage remembers what a slow motion would have made it
  /// remember and no wall is jumped over. A wall has been crossed where a contact that stood against such a motion is gone, or
  /// pushes on, at a later sub-pose or in a later frame, slow ones included, before the tool was back where it stood against it.
  /// Then the frame's contact is that of the sub-pose where it stood against the motion most, and it is
  /// held (`StageResult::crossed`) while the tool is behind: until the way from there to the tool crosses nothing any more, or the
  /// tool is farther than twice its reach and what a frame walks. The kept force never points away from the side of entry:
  /// F . (x - c) + M . turn < 0 for the kept pose c. Faster motions are not walked (`StageResult::missed`). Slower ones cost nothing.
  ///
  /// With a budget a frame tests at most so many points, a fast one a tenth of them in each look-up; points are left out by levels, and what
  /// touched in the frame before is not lost (level_query.hpp).
  StageResult render(const Pose& pose_WT) noexcept;

  /// Forgets all frames so far: after a restart of the device, or a jump of the tool that was no motion.
  void reset() noexcept {
    stage_.reset(), entry_kind_ = Entry::kNone;
    if (budget_points_ > 0) touched_.clear();
  }

  /// Longest way of a point within a frame [m] for which no wall is crossed unseen; over the period it is the top speed.
  double swept_m() const noexcept {
    return limits::kMaxSubPoses * limits::kSubStepEdges * query_.voxmap().grid().edge;
  }
  /// Sub-poses looked up since construction, the one of the frame itself not counted: what fast motion has cost.
  std::uint64_t sub_poses() const noexcept { return sub_poses_; }

  /// The model alone, without memory and without touching the ring's; with a budget as a slow frame has it. Real-time safe.
  ContactResult probe(const Pose& pose_WT) noexcept;
  /// The same, with the ids (`Pointshell::id`) of the points in surface voxels, ascending. Allocates.
  ContactResult probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids);

  /// The hits of the last `render` or `probe`.
  const HitList& hits() const noexcept { return hits_; }
  const ContactQuery& query() const noexcept { return query_; }
  ContactModelKind model() const noexcept { return model_->kind(); }

 private:
  ContactResult evaluate_for_stage(const Pose& pose_WT) noexcept;
  bool is_fast(const Pose& pose_WT) const noexcept;
  void remember_touched() noexcept {
    if (budget_points_ > 0 && hits_.pose_status == PoseStatus::kUsable) touched_.take(hits_);
  }
  StageResult render_fast(const ContactResult& plain, double moved_m) noexcept;
  void leave_far_side(bool to_entry) noexcept;
  bool beyond_entry(const Pose& tool) const noexcept;
  StageResult walk(const MotionPath& path, int steps, const ContactResult& plain_at_end) noexcept;

  ContactQuery query_;
  std::unique_ptr<ContactModel> model_;
  ContactStage stage_;
  HitList hits_;
  std::uint32_t budget_points_ = 0;  ///< 0: none
  TouchedPoints touched_;
  PointLimit limit_;                 ///< of the look-ups of this frame
  enum class Entry : std::uint8_t {
    kNone,
    kWatched,  ///< a fast motion met a contact that stands against it: crossed, should that be lost
    kBehind,   ///< the tool is on the far side
  };
  Entry entry_kind_ = Entry::kNone;
  StageResult entry_;           ///< the contact that stood against the motion most ...
  ContactStage entry_stage_;    ///< ... what was remembered there ...
  Pose entry_pose_;             ///< ... and where it was found
  Pose tool_pose_;              ///< of the last frame, while there is an entry
  std::uint64_t sub_poses_ = 0;
};

}  // namespace voxtouch::contact
