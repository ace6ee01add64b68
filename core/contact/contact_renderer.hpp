#pragma once
/// The whole way from a pose to a wrench behind one class: query, model, stage.
#include <memory>
#include <vector>

#include "core/contact/contact_model.hpp"
#include "core/contact/contact_query.hpp"
#include "core/contact/contact_stage.hpp"

namespace voxtouch {

/// What a rendering node holds for one tool in one scene. The voxmap must outlive it. One thread at a time: `render` and
/// `probe` share the list of hits.
class ContactRenderer {
 public:
  /// `field` is looked up by the model of that name only, and must outlive the renderer too. Throws std::invalid_argument for
  /// a model that does not exist or lacks its field, a stiffness or a shell that cannot be used.
  ContactRenderer(const Voxmap& voxmap, Pointshell shell, ContactModelKind model, const ContactParameters& parameters,
                  const DistanceField* field = nullptr);
  ContactRenderer(Voxmap&&, Pointshell, ContactModelKind, const ContactParameters&, const DistanceField* = nullptr) = delete;

  /// One frame of the ring, `tool_in_world` = T in W. Real-time safe. A pose that cannot be looked up gives a zero wrench and
  /// the reason in `contact.pose_status`, and leaves the stage as it was.
  StageResult render(const Pose& tool_in_world) noexcept;

  /// Forgets all frames so far: after a restart of the device, or a jump of the tool that was no motion.
  void reset() noexcept { stage_.reset(); }

  /// The model alone, without memory and without touching the ring's. Real-time safe.
  ContactResult probe(const Pose& tool_in_world) noexcept;
  /// The same, with the ids (`Pointshell::id`) of the points in surface voxels, ascending. Allocates.
  ContactResult probe(const Pose& tool_in_world, std::vector<std::uint32_t>& surface_ids);

  /// The hits of the last `render` or `probe`.
  const HitList& hits() const noexcept { return hits_; }
  const ContactQuery& query() const noexcept { return query_; }
  ContactModelKind model() const noexcept { return model_->kind(); }

 private:
  ContactQuery query_;
  std::unique_ptr<ContactModel> model_;
  ContactStage stage_;
  HitList hits_;
};

}  // namespace voxtouch
