#pragma once
/// The whole way from a pose to a wrench behind one class: query, model, stage.
#include <memory>
#include <optional>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/contact_stage.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::contact {

/// A time budget as counts.
struct FrameBudget {
  /// Points that a frame may test at most; 0: any number, and no levels.
  std::uint32_t points = 0;
  pointshell::ShellLevels levels =
      {};  ///< of the shell; none: the shell has so few points that nothing is ever left out

  /// What the coarsest level may have at most: room for all of it and for as many leaves of
  /// contacts in a tenth of the points, so that finer levels come and go in small steps.
  static constexpr std::uint32_t kShares = 10 * (SphereTree::kLeafPoints + 1);
  static constexpr std::uint32_t coarsest_of(std::uint32_t points) noexcept {
    return points / kShares < SphereTree::kLeafPoints ? SphereTree::kLeafPoints : points / kShares;
  }
  /// The least with which nothing that this promises is lost.
  static constexpr std::uint32_t kMinPoints = SphereTree::kLeafPoints * kShares;
};

/// What a rendering node holds for one tool in one scene. The voxmap must outlive it. One thread at
/// a time: `render` and `probe` share the list of hits.
class ContactRenderer {
 public:
  /// `field` is looked up by the model of that name only, and must outlive the renderer too. Throws
  /// std::invalid_argument for a model that does not exist or lacks its field, a stiffness or a
  /// shell that cannot be used.
  ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
                  ContactModelKind model, const ContactParameters& parameters,
                  const voxmap::DistanceField* field = nullptr, FrameBudget budget = {});
  ContactRenderer(voxmap::Voxmap&&, pointshell::Pointshell, ContactModelKind,
                  const ContactParameters&, const voxmap::DistanceField* = nullptr,
                  FrameBudget = {}) = delete;

  /// One frame of the ring, `pose_WT` = T in W. Real-time safe. A pose that cannot be looked up
  /// gives a zero wrench and the reason in `contact.pose_status`, and leaves the stage as it was.
  ///
  /// Fast motion. What lies between two frames is not looked at. Where some point may have moved
  /// more than e/2 since the last frame it may have jumped over a wall of a voxel: the frame is
  /// `fast`, and `missed` too unless the scene is so far away that nothing can have lain in
  /// between.
  ///
  /// A model alone (ContactParameters) holds nothing in a wall. While the tool's middle is in a
  /// surface or interior voxel the frame is `passing`: it is going through, or has gone in. The
  /// middle is that of the shell's area; where that lies outside the tool, as of a bowl, nothing is
  /// told.
  ///
  /// With a budget a frame tests at most so many points; points are left out by levels, and what
  /// touched in the frame before is not lost (level_query.hpp).
  StageResult render(const Pose& pose_WT) noexcept;

  /// Forgets all frames so far: after a restart of the device, or a jump of the tool that was no
  /// motion.
  void reset() noexcept {
    stage_.reset();
    if (budget_points_ > 0)
      touched_.clear();
  }

  /// The model alone, without memory and without touching the ring's; with a budget as a first
  /// frame has it. Real-time safe.
  ContactResult probe(const Pose& pose_WT) noexcept;
  /// The same, with the ids (`Pointshell::id`) of the points in surface voxels, ascending.
  /// Allocates.
  ContactResult probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids);

  /// The hits of the last `render` or `probe`.
  const HitList& hits() const noexcept { return hits_; }
  const ContactQuery& query() const noexcept { return query_; }
  ContactModelKind model() const noexcept { return model_->kind(); }

 private:
  bool near_within(double moved_m) const noexcept;
  bool middle_in_something() const noexcept;

  ContactQuery query_;
  std::unique_ptr<ContactModel> model_;
  ContactStage stage_;
  HitList hits_;
  bool alone_;
  std::optional<Vec3> middle_T_;     ///< of a model alone, where it is inside the tool
  std::uint32_t budget_points_ = 0;  ///< 0: none
  TouchedPoints touched_;
};

}  // namespace voxtouch::contact
