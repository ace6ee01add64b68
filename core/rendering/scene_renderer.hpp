#pragma once
/// Renders one sample of a scene: the contact, the effects, and their sum.
#include <optional>
#include <span>

#include "core/effects/effect_chain.hpp"
#include "core/effects/rigid_body.hpp"
#include "core/rendering/constrained_tool.hpp"
#include "core/rendering/device_mapping.hpp"
#include "core/rendering/exact_bodies.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/series_spring.hpp"

namespace voxtouch::rendering {

/// Result of one sample, W axes, torques about the tool's origin.
///
/// Virtual tool or series spring: `touch` has the wrench of the spring. Wrenches of surface effects
/// on the virtual tool are displayed unchanged.
/// Body: `touch` and `effects` act on the body, about its origin; `wrench` and stiffness are those
/// of the grip.
struct SceneFrame {
  Pose object;                   ///< of body or tool at the contact; may differ from the hand
  ToolFrame tool;                ///< of a virtual tool; all zero without one
  contact::StageResult touch;    ///< contact only
  effects::EffectForce effects;  ///< effects only; all zero for a scene without effects
  Wrench wrench;                 ///< on the hand: the sum of both, or of the grip
  Mat6 stiffness = Mat6::Zero();
  double stiffness_bound_n_per_m = 0.0;
  /// Upper bound of the energy given to the operator since the start of the session [J]. Its
  /// sources are decreasing potentials, moving objects, effects bounded by the path, and the weight
  /// and speed of the body.
  double supplied_energy_j = 0.0;
};

/// Resources of the effects; each is present only if an effect needs it.
struct EffectResources {
  const effects::Proximity* proximity = nullptr;
  std::span<const effects::ToolPoint> tool_points = {};
  std::optional<effects::BodyShape> body =
      {};  ///< mass properties of the dynamic object, for the effect `body`
  const ExactBodies* bodies = nullptr;  ///< with a virtual tool
  double virtual_tool_lever_m = 0.0;    ///< with a virtual tool, above 0
};

/// Renders a scene. One thread at a time. `contact` and the referenced `resources` must outlive it.
class SceneRenderer {
 public:
  /// Valid time steps. The first sample, or one with a step out of range, gets `kDefaultStepS`.
  static constexpr double kDefaultStepS = 0.001, kMinStepS = 1e-5, kLongestStepS = 0.05;

  /// Throws std::invalid_argument for invalid effects, or if the shape of a body is missing.
  SceneRenderer(ObjectContacts& contact, std::vector<effects::EffectSpec> effects,
                const EffectResources& resources = {});

  /// Renders one sample; `time_s` counts from the start of the session. An invalid pose gives no
  /// force. Real-time safe.
  SceneFrame render(const ToolState& tool, double time_s) noexcept {
    // Separate functions construct the frame in place; one with two returns would copy it.
    if (constrained_)
      return render_constrained(tool, time_s);
    return body_ || series_.rigid() ? render_direct(tool, time_s) : render_in_series(tool, time_s);
  }
  /// Clears all state of previous samples.
  void reset() noexcept;
  /// For a gap in the samples, after which the hand may be anywhere: places a virtual tool at the
  /// hand if that is in free space; otherwise the tool stays in place. Real-time safe.
  void reset_virtual_tool() noexcept {
    if (constrained_)
      constrained_->expect_jump();
    series_.lose();
  }
  /// Sets the stiffness of the virtual tool's spring, in W [N/m]; see ConstrainedTool::set_target.
  /// Real-time safe.
  void set_spring_target(double n_per_m) noexcept {
    if (constrained_)
      constrained_->set_target(n_per_m);
  }
  /// Sets the spring in series with the contact (without a virtual tool) or a body's grip, in W.
  /// `effects` is that of a second spring, for position-dependent forces (guides, magnets, fields)
  /// that would leave the contact less than half of the certified stiffness. Their largest force is
  /// still displayed, at an additional displacement of the hand. Real-time safe.
  void set_series_target(const Compliance& spring) noexcept {
    series_.set_target({spring.translation, spring.returns_torque() ? spring.rotation : 0.0});
    field_.set_target({spring.effects, 0.0});
  }
  /// Whether the dynamic object is a body, which the hand grips.
  bool grips_a_body() const noexcept { return body_.has_value(); }
  /// Sets the wrench for the effect `external` from the next sample on. Real-time safe.
  void set_external_wrench(const effects::ExternalWrench& newest) noexcept { external_ = newest; }
  /// Takes over the virtual tool of `before`, if both scenes have one and its pose is free in this
  /// one. Real-time safe.
  void start_tool_from(const SceneRenderer& before, double time_s) noexcept;

  /// Input of the effects for a sample `step_s` [s] after the last one; refers to `contacts`.
  /// Real-time safe.
  effects::EffectFrame effect_frame(
      const ToolState& object, double step_s, double time_s,
      std::span<const effects::ObjectContact> contacts) const noexcept;

  effects::EffectChain& effects() noexcept { return effects_; }
  const effects::EffectChain& effects() const noexcept { return effects_; }

 private:
  struct BodyPart {
    effects::RigidBody body;
    std::size_t effect = 0;  ///< index in the chain
  };
  SceneFrame render_direct(const ToolState& tool, double time_s) noexcept;
  SceneFrame render_constrained(const ToolState& tool, double time_s) noexcept;
  SceneFrame render_in_series(const ToolState& tool, double time_s) noexcept;
  bool settle_in_series(double time_s, contact::StageResult& touch) noexcept;
  void add_effects_at_both(const ToolState& hand, const Twist& tool_twist,
                           std::span<const effects::ObjectContact> parts, double time_s,
                           double dt_s, SceneFrame& frame) noexcept;
  void add(const effects::EffectForce& effects, SceneFrame& frame) noexcept;
  effects::EffectForce effects_at(const ToolState& hand, const effects::EffectFrame& frame,
                                  const effects::EffectFrame* surface) noexcept;
  double step_to(double time_s) noexcept;
  const Pose& object_pose(const Pose& tool) const noexcept;
  void add_rest(const ToolState& tool, double time_s, SceneFrame& frame) noexcept;
  void add_effects(const ToolState& object, double time_s, double dt_s, SceneFrame& frame) noexcept;
  void supply(const Pose& object, double energy_generated_j, SceneFrame& frame) noexcept;
  void soften_grip(const Pose& tool, double dt_s, double lever_m,
                   effects::BodyParameters& parameters) noexcept;
  void move_body(const ToolState& tool, double dt_s, SceneFrame& frame) noexcept;

  ObjectContacts& contact_;
  effects::EffectChain effects_;
  EffectResources resources_;
  bool has_effects_or_motion_;  ///< anything except contact with resting objects
  std::optional<BodyPart> body_;
  std::optional<ConstrainedTool> constrained_;
  SeriesSpring series_, field_;  ///< of the contact, and of position-dependent forces
  std::optional<double> last_s_, potential_j_;
  std::optional<Vec3> last_position_;
  std::optional<effects::ExternalWrench> external_;
  double supplied_j_ = 0.0;
};

}  // namespace voxtouch::rendering
