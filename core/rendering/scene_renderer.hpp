#pragma once
/// One sample of the whole scene: contact, then the effects that the scene lists, then their sum.
#include <optional>
#include <span>

#include "core/effects/effect_chain.hpp"
#include "core/effects/rigid_body.hpp"
#include "core/rendering/constrained_tool.hpp"
#include "core/rendering/device_mapping.hpp"
#include "core/rendering/exact_bodies.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/series_spring.hpp"
#include "core/rendering/wall_watch.hpp"

namespace voxtouch::rendering {

/// W axes. Without a body all of it is about the tool's origin, which is the object's; with one,
/// `touch` and `effects` act on the body, about its origin, and `wrench` and the stiffness are the
/// grip's, about the tool's. With a virtual tool, or a spring in series, `touch` is the spring's
/// wrench, which acts on both of its ends alike; what effects of the surface give where the virtual
/// tool is, the hand feels as it is.
struct SceneFrame {
  Pose object;     ///< where the dynamic object was when the contact was found: the tool, which a
                   ///< spring or a virtual tool holds off the hand, or the body
  ToolFrame tool;  ///< of a virtual tool; all zero without one
  contact::StageResult touch;    ///< contact alone
  effects::EffectForce effects;  ///< effects alone; all zero where the scene lists none
  Wrench wrench;                 ///< for the hand: the sum of both, or the grip
  Mat6 stiffness = Mat6::Zero();
  double stiffness_bound_n_per_m = 0.0;
  /// What the hand may have been given since the session began, by potentials that fell, moving
  /// objects, effects that are bounded by the path, or the body's weight and speed [J].
  double supplied_energy_j = 0.0;
};

/// What effects look up, where one asks for it.
struct EffectResources {
  const effects::Proximity* proximity = nullptr;
  std::span<const effects::ToolPoint> tool_points = {};
  std::optional<effects::BodyShape> body =
      {};  ///< of the dynamic object, for scenes with the effect of that name
  std::optional<double> virtual_tool_lever_m =
      {};  ///< there is a virtual tool, with this lever; 0: the tool's reach
  const WallWatch* watch = nullptr;     ///< with one
  const ExactBodies* bodies = nullptr;  ///< with one that meets triangles
};

/// One thread at a time. `contact` and what `resources` points to must outlive it.
class SceneRenderer {
 public:
  /// Time steps that effects are given lie within these: a first sample, or one after a gap, counts
  /// as one of `kDefaultStepS`.
  static constexpr double kDefaultStepS = 0.001, kMinStepS = 1e-5, kLongestStepS = 0.05;

  /// std::invalid_argument where a body's shape is missing.
  SceneRenderer(ObjectContacts& contact, std::vector<effects::EffectSpec> effects,
                const EffectResources& resources = {});

  /// `time_s` counts from the session's begin. A pose that cannot be looked up gives no force from
  /// anything. Real-time safe.
  SceneFrame render(const ToolState& tool, double time_s) noexcept {
    // Two functions, so that each builds its frame in place: one with two ways out would copy it.
    if (constrained_)
      return render_constrained(tool, time_s);
    return body_ || series_.rigid() ? render_pushed(tool, time_s) : render_in_series(tool, time_s);
  }
  /// Forgets all samples so far.
  void reset() noexcept;
  /// Samples were missing for longer than the last one is repeated: the hand may be anywhere. A
  /// virtual tool is placed anew where the hand is free; else it stays. Real-time safe.
  void lose_tool() noexcept {
    if (constrained_)
      constrained_->lose_hand();
    series_.lose();
  }
  /// Stiffness of the virtual tool's spring, in W [N/m]; see ConstrainedTool::set_target. Real-time
  /// safe.
  void set_spring_target(double n_per_m) noexcept {
    if (constrained_)
      constrained_->set_target(n_per_m);
  }
  /// Without a virtual tool: the spring in series with the contact, or with a body's grip, in W.
  /// Real-time safe. Forces of position (guides, magnets, fields) whose stiffness leaves the
  /// contact less than half of what is certified act behind a spring of their own: their largest
  /// force is given whole, at a displacement of the hand that the spring adds. Real-time safe.
  void set_series_target(const Compliance& spring) noexcept {
    series_.set_target({spring.translation, spring.returns_torque() ? spring.rotation : 0.0});
    field_.set_target({spring.effects, 0.0});
  }
  /// A body is gripped, which is turned against its inertia.
  bool grips_a_body() const noexcept { return body_.has_value(); }
  /// What the effect `external` follows from the next sample on. Real-time safe.
  void external_is(const effects::ExternalWrench& newest) noexcept { external_ = newest; }
  /// The virtual tool of `before`, where both scenes have one and its place is free in this one, is
  /// this one's from now on. Real-time safe.
  void start_tool_from(const SceneRenderer& before, double time_s) noexcept;

  /// What the effects are given for a sample `step_s` after the last one; points into `contacts`.
  /// Real-time safe.
  effects::EffectFrame look(const ToolState& object, double step_s, double time_s,
                            std::span<const effects::ObjectContact> contacts) const noexcept;

  effects::EffectChain& effects() noexcept { return effects_; }
  const effects::EffectChain& effects() const noexcept { return effects_; }

 private:
  struct BodyPart {
    effects::RigidBody body;
    std::size_t effect = 0;  ///< place in the chain
  };
  SceneFrame render_pushed(const ToolState& tool, double time_s) noexcept;
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
  bool has_effects_or_motion_;  ///< than contact with what rests
  std::optional<BodyPart> body_;
  std::optional<ConstrainedTool> constrained_;
  SeriesSpring series_, field_;  ///< of the contact, and of forces of position
  std::optional<double> last_s_, potential_j_;
  std::optional<Vec3> last_position_;
  std::optional<effects::ExternalWrench> external_;
  double supplied_j_ = 0.0;
};

}  // namespace voxtouch::rendering
