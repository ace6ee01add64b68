#pragma once
/// The complete contact computation from pose to wrench: query, model and stage.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/contact_stage.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::contact {

/// Contact of one tool with one scene. The voxmap must outlive it. One thread at a time: `render`
/// and `probe` share the list of hits.
class ContactRenderer {
 public:
  /// `field` is used only by the model of that name, and must outlive the renderer. Throws
  /// std::invalid_argument for an unknown model, a missing field, or an invalid stiffness or shell.
  ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
                  ContactModelKind model, const ContactParameters& parameters,
                  const voxmap::DistanceField* field = nullptr);
  ContactRenderer(voxmap::Voxmap&&, pointshell::Pointshell, ContactModelKind,
                  const ContactParameters&, const voxmap::DistanceField* = nullptr) = delete;

  /// Computes one frame of the ring; `pose_WT` is T in W. Real-time safe. An invalid pose gives a
  /// zero wrench with the reason in `contact.pose_status`, and leaves the stage unchanged.
  /// If some point may have moved more than e/2 since the last frame, it may have jumped over a
  /// wall of one voxel, and the frame is `fast`. It is also `tunnelling_suspected` unless the scene
  /// is too far away.
  /// With the option `memoryless` (ContactParameters), no depth is latched in a wall. The frame is
  /// `passed_through` while the centre of the shell's area is in a surface or interior voxel. This
  /// cannot occur if the centre lies outside the tool, as for a bowl.
  StageResult render(const Pose& pose_WT) noexcept;

  /// `render` in steps, for objects that form one solid: find hits, combine normals and memories,
  /// render. Real-time safe.
  void find(const Pose& pose_WT) noexcept { query_.find(pose_WT, hits_); }
  StageResult render_found() noexcept;
  /// Replaces mean normal and coherence by those of the hits of all members.
  static void share_normals(std::span<ContactRenderer* const> members) noexcept;
  /// Combines the memories. The members have one grid and disjoint voxels.
  static void share_memory(std::span<ContactRenderer* const> members) noexcept;

  /// Forgets all previous frames, after a restart of the device or a jump of the tool.
  void reset() noexcept { stage_.reset(); }

  /// Evaluates the model without memory and without changing the state of the ring. Real-time safe.
  ContactResult probe(const Pose& pose_WT) noexcept;
  /// The same, with the ids (`Pointshell::id`) of the points in surface voxels, ascending.
  /// Allocates.
  ContactResult probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids);
  /// The same for the hits of `find`.
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
  /// Area centre for the memoryless option, if it is inside the tool.
  std::optional<Vec3> middle_T_;
};

}  // namespace voxtouch::contact
