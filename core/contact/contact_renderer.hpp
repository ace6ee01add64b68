#pragma once
/// The whole way from a pose to a wrench behind one class: query, model, stage.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/contact_stage.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::contact {

/// What a rendering node holds for one tool in one scene. The voxmap must outlive it. One thread at
/// a time: `render` and `probe` share the list of hits.
class ContactRenderer {
 public:
  /// `field` is looked up by the model of that name only, and must outlive the renderer too. Throws
  /// std::invalid_argument for a model that does not exist or lacks its field, a stiffness or a
  /// shell that cannot be used.
  ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
                  ContactModelKind model, const ContactParameters& parameters,
                  const voxmap::DistanceField* field = nullptr);
  ContactRenderer(voxmap::Voxmap&&, pointshell::Pointshell, ContactModelKind,
                  const ContactParameters&, const voxmap::DistanceField* = nullptr) = delete;

  /// One frame of the ring, `pose_WT` = T in W. Real-time safe. A pose that cannot be looked up
  /// gives a zero wrench and the reason in `contact.pose_status`, and leaves the stage as it was.
  ///
  /// Where some point may have moved more than e/2 since the last frame it may have jumped over a
  /// wall of a voxel: the frame is `fast`, and `tunnelling_suspected` too unless the scene is so
  /// far away that nothing can have lain in between.
  ///
  /// A model alone (ContactParameters) holds nothing in a wall. While the middle of the shell's
  /// area is in a surface or interior voxel the frame is `passed_through`; never where that middle
  /// lies outside the tool, as of a bowl.
  StageResult render(const Pose& pose_WT) noexcept;

  /// `render` in steps, for objects that are one solid: each finds its hits, all share their
  /// normals and what they remember, and each renders. Real-time safe.
  void find(const Pose& pose_WT) noexcept { query_.find(pose_WT, hits_); }
  StageResult render_found() noexcept;
  /// The mean normal, and whether the normals agree, become those of all members' hits.
  static void share_normals(std::span<ContactRenderer* const> members) noexcept;
  /// No member's voxels are another's, and all lie on one grid.
  static void share_memory(std::span<ContactRenderer* const> members) noexcept;

  /// Forgets all frames so far: after a restart of the device, or a jump of the tool that was no
  /// motion.
  void reset() noexcept { stage_.reset(); }

  /// The model alone, without memory and without touching the ring's. Real-time safe.
  ContactResult probe(const Pose& pose_WT) noexcept;
  /// The same, with the ids (`Pointshell::id`) of the points in surface voxels, ascending.
  /// Allocates.
  ContactResult probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids);
  /// The same for what `find` found.
  ContactResult probe_found(std::vector<std::uint32_t>& surface_ids) const;

  /// The hits of the last `render` or `probe`.
  const HitList& hits() const noexcept { return hits_; }
  const ContactQuery& query() const noexcept { return query_; }
  ContactModelKind model() const noexcept { return model_->kind(); }

 private:
  bool near_within(double moved_m) const noexcept;
  bool tool_centre_in_solid() const noexcept;

  ContactQuery query_;
  std::unique_ptr<ContactModel> model_;
  ContactStage stage_;
  HitList hits_;
  bool memoryless_;
  std::optional<Vec3> middle_T_;  ///< of a model alone, where it is inside the tool
};

}  // namespace voxtouch::contact
