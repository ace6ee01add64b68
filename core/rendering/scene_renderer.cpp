#include "core/rendering/scene_renderer.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/effects/body.hpp"

namespace voxtouch::rendering {

SceneRenderer::SceneRenderer(ObjectContacts& contact, std::vector<effects::EffectSpec> effects,
                             const EffectResources& resources)
    : contact_(contact),
      effects_(std::move(effects)),
      resources_(resources),
      has_effects_or_motion_(!effects_.empty() || contact.moves()) {
  for (std::size_t n = 0; n < effects_.size(); ++n) {
    if (!effects_.spec(n).kind->needs(effects_.spec(n).values).body)
      continue;
    if (!resources.body)
      throw std::invalid_argument("the effect 'body' needs the shape of the dynamic object");
    body_.emplace(BodyPart{effects::RigidBody(*resources.body), n});
  }
  if (resources.bodies != nullptr)
    constrained_.emplace(contact, *resources.bodies, resources.virtual_tool_lever_m);
}

/// The contact is computed at the pose of the hand, or of the body.
SceneFrame SceneRenderer::render_direct(const ToolState& tool, double time_s) noexcept {
  SceneFrame frame;
  frame.object = body_ ? object_pose(tool.pose) : tool.pose;
  frame.touch = contact_.render(frame.object, time_s);
  const contact::ContactResult& contact = frame.touch.contact;
  frame.wrench = contact.wrench;
  frame.stiffness = contact.stiffness;
  frame.stiffness_bound_n_per_m = contact.stiffness_bound_n_per_m;
  if (has_effects_or_motion_ && contact.pose_status == contact::PoseStatus::kUsable)
    add_rest(tool, time_s, frame);
  return frame;
}

/// The contact is the spring between hand and virtual tool.
SceneFrame SceneRenderer::render_constrained(const ToolState& tool, double time_s) noexcept {
  const double dt_s = step_to(time_s);
  SceneFrame frame;
  const double friction =
      effects_.friction_at(constrained_->pose().position, constrained_->contact_object());
  frame.touch.contact = constrained_->render(tool.pose, time_s, dt_s, friction, frame.tool);
  const contact::ContactResult& contact = frame.touch.contact;
  frame.object = constrained_->pose();
  frame.wrench = contact.wrench;
  frame.stiffness = contact.stiffness;
  frame.stiffness_bound_n_per_m = contact.stiffness_bound_n_per_m;
  if (contact.pose_status != contact::PoseStatus::kUsable)
    return frame;
  if (!effects_.empty())
    add_effects_at_both(tool, constrained_->twist(), constrained_->parts(), time_s, dt_s, frame);
  supply(tool.pose, dt_s * constrained_->power_w() + constrained_->stiffened_j(), frame);
  return frame;
}

/// Surface effects act where the tool is in contact, spatial effects at the hand.
void SceneRenderer::add_effects_at_both(const ToolState& hand, const Twist& tool_twist,
                                        std::span<const effects::ObjectContact> parts,
                                        double time_s, double dt_s, SceneFrame& frame) noexcept {
  ToolState tool = hand;
  tool.pose = frame.object, tool.twist = tool_twist;
  const effects::EffectFrame surface = effect_frame(tool, dt_s, time_s, parts);
  add(effects_at(hand, effect_frame(hand, dt_s, time_s, parts), &surface), frame);
}

/// The contact is computed at the equilibrium of spring and contact, mostly with one query.
SceneFrame SceneRenderer::render_in_series(const ToolState& tool, double time_s) noexcept {
  const double dt_s = step_to(time_s);
  SceneFrame frame;
  series_.begin(tool.pose, dt_s);
  while (settle_in_series(time_s, frame.touch)) {
  }
  contact::ContactResult& contact = frame.touch.contact;
  if (contact.pose_status != contact::PoseStatus::kUsable) {
    frame.object = tool.pose;
    return frame;
  }
  const double series_ratio =
      1.0 / (1.0 + series_.compliance().translation * contact.stiffness_bound_n_per_m);
  contact.wrench = series_.wrench();
  contact.stiffness = in_series(contact.stiffness, series_.compliance());
  contact.stiffness_bound_n_per_m *= series_ratio;
  contact_.soften(series_ratio);
  frame.object = series_.tool();
  frame.wrench = contact.wrench;
  frame.stiffness = contact.stiffness;
  frame.stiffness_bound_n_per_m = contact.stiffness_bound_n_per_m;
  if (!has_effects_or_motion_)
    return frame;
  // All effects act at the equilibrium, also friction, which the spring itself does not have.
  ToolState at_balance = tool;
  at_balance.pose = frame.object;
  if (!effects_.empty())
    add(effects_at(tool, effect_frame(at_balance, dt_s, time_s, contact_.parts(frame.touch)),
                   nullptr),
        frame);
  supply(frame.object, dt_s * contact_.power_w(), frame);
  return frame;
}

/// Queries the contact at the tool's pose. Returns true if another query is needed.
bool SceneRenderer::settle_in_series(double time_s, contact::StageResult& touch) noexcept {
  const bool fast = touch.fast, tunnelling_suspected = touch.tunnelling_suspected,
             passed_through = touch.passed_through;
  touch = contact_.render(series_.tool(), time_s);
  touch.fast |= fast, touch.tunnelling_suspected |= tunnelling_suspected,
      touch.passed_through |= passed_through;
  if (touch.contact.pose_status != contact::PoseStatus::kUsable) {
    series_.lose();
    return false;
  }
  return series_.settle({touch.contact.wrench, touch.contact.stiffness});
}

void SceneRenderer::start_tool_from(const SceneRenderer& before, double time_s) noexcept {
  if (constrained_ && before.constrained_ && before.constrained_->placed())
    constrained_->start_from(before.constrained_->pose(), time_s);
}

const Pose& SceneRenderer::object_pose(const Pose& tool) const noexcept {
  return body_->body.placed() ? body_->body.pose() : tool;
}

void SceneRenderer::add_rest(const ToolState& tool, double time_s, SceneFrame& frame) noexcept {
  ToolState object = tool;
  object.pose = frame.object;
  if (body_)
    object.twist = body_->body.twist();
  const double dt_s = step_to(time_s);
  if (!effects_.empty() && body_)
    add_effects(object, time_s, dt_s, frame);
  if (!effects_.empty() && !body_)
    add(effects_at(object, effect_frame(object, dt_s, time_s, contact_.parts(frame.touch)),
                   nullptr),
        frame);
  if (body_) {
    move_body(tool, dt_s, frame);
  } else {
    supply(object.pose, dt_s * contact_.power_w(), frame);
  }
}

double SceneRenderer::step_to(double time_s) noexcept {
  const double step = last_s_ ? time_s - *last_s_ : kDefaultStepS;
  last_s_ = time_s;
  return step >= kMinStepS && step <= kLongestStepS ? step : kDefaultStepS;
}

void SceneRenderer::add_effects(const ToolState& object, double time_s, double dt_s,
                                SceneFrame& frame) noexcept {
  add(effects_.apply(effect_frame(object, dt_s, time_s, contact_.parts(frame.touch))), frame);
}

/// Sum of the effects for `frame`. A spring between hand and position-dependent forces replaces
/// their force, softens their stiffness and adds its energy.
effects::EffectForce SceneRenderer::effects_at(const ToolState& hand,
                                               const effects::EffectFrame& frame,
                                               const effects::EffectFrame* surface) noexcept {
  if (field_.rigid())
    return effects_.apply(frame, surface);
  effects::EffectFrame behind = frame;
  effects::EffectForce there;
  behind.tool = field_.begin(hand.pose, frame.dt_s);
  do {
    behind.tool = field_.tool();
    there = effects_.of_position(behind);
  } while (field_.settle({there.wrench, there.stiffness}));
  const double series_compliance = field_.compliance().translation;
  effects::EffectForce sum = effects_.apply(frame, surface, &behind);
  there = effects_.of_position(behind);  // with the gains of this sample
  sum.wrench.force += field_.wrench().force - there.wrench.force;
  sum.stiffness += in_series(there.stiffness, field_.compliance()) - there.stiffness;
  sum.stiffness_bound_n_per_m -=
      there.stiffness_bound_n_per_m -
      there.stiffness_bound_n_per_m / (1.0 + series_compliance * there.stiffness_bound_n_per_m);
  sum.potential_j +=
      0.5 * series_compliance * field_.wrench().force.squaredNorm();  // of the spring
  return sum;
}

void SceneRenderer::add(const effects::EffectForce& effects, SceneFrame& frame) noexcept {
  frame.effects = effects;
  frame.wrench.force += frame.effects.wrench.force;
  frame.wrench.torque += frame.effects.wrench.torque;
  frame.stiffness += frame.effects.stiffness;
  frame.stiffness_bound_n_per_m += frame.effects.stiffness_bound_n_per_m;
}

effects::EffectFrame SceneRenderer::effect_frame(
    const ToolState& object, double step_s, double time_s,
    std::span<const effects::ObjectContact> contacts) const noexcept {
  effects::EffectFrame in;
  in.tool = object.pose;
  in.twist = object.twist;
  in.dt_s = step_s >= kMinStepS && step_s <= kLongestStepS ? step_s : kDefaultStepS;
  in.time_s = time_s;
  in.contacts = contacts;
  in.proximity = resources_.proximity, in.tool_points = resources_.tool_points;
  in.external = external_ ? &*external_ : nullptr;
  return in;
}

/// Adds the energy of this sample to that supplied. `energy_generated_j`: of sources other than
/// effects [J].
void SceneRenderer::supply(const Pose& object, double energy_generated_j,
                           SceneFrame& frame) noexcept {
  const double potential = frame.effects.potential_j;
  supplied_j_ += potential_j_.value_or(potential) - potential + energy_generated_j +
                 frame.effects.energy_generated_j +
                 effects_.max_energy_generated_j(
                     (object.position - last_position_.value_or(object.position)).norm());
  potential_j_ = potential;
  last_position_ = object.position;
  frame.supplied_energy_j = supplied_j_;
}

/// Combines grip and series spring: each stiffness k becomes k / (1 + c k), c the compliance of the
/// spring. If the body may be gripped off its origin, by up to `lever_m` [m], the force of the grip
/// also rotates the hand. The factor for rotations then includes its stiffness and scales both. The
/// weight of the body is still supported in full.
void SceneRenderer::soften_grip(const Pose& tool, double dt_s, double lever_m,
                                effects::BodyParameters& parameters) noexcept {
  series_.begin(tool, dt_s);
  const Compliance& spring = series_.compliance();
  parameters.grip_n_per_m /= 1.0 + spring.translation * parameters.grip_n_per_m;
  const double across = parameters.grip_n_per_m * lever_m * lever_m;
  const double series_ratio = 1.0 / (1.0 + spring.rotation * (parameters.grip_nm_per_rad + across));
  parameters.grip_nm_per_rad *= series_ratio;
  if (lever_m > 0.0)
    parameters.grip_n_per_m *= series_ratio;
}

void SceneRenderer::move_body(const ToolState& tool, double dt_s, SceneFrame& frame) noexcept {
  const effects::EffectValues& values = effects_.values(body_->effect);
  effects::RigidBody& body = body_->body;
  const int button = effects::grab_button(values);
  const bool hold = button < 0 || (tool.buttons >> button & 1U) != 0;
  effects::BodyLoad load;
  if (body.placed()) {
    load.wrench = frame.wrench;
    load.stiffness = frame.stiffness;
    load.stiffness_bound_n_per_m = frame.stiffness_bound_n_per_m;
    for (const effects::ObjectContact& part : contact_.parts(frame.touch))
      load.stiffness_times_velocity += part.contact->stiffness.leftCols<3>() * part.twist.linear;
  } else {
    body.place(tool.pose, hold);
  }
  effects::BodyParameters parameters = effects::body_parameters(values);
  soften_grip(tool.pose, dt_s, button < 0 ? 0.0 : effects::grab_distance_m(values), parameters);
  const effects::BodyGrip grip = body.step(load, tool.pose, tool.twist, hold,
                                           effects::grab_distance_m(values), parameters, dt_s);
  supplied_j_ = potential_j_.value_or(body.energy_j()) - body.energy_j();
  if (!potential_j_)
    potential_j_ = body.energy_j();  // initial value
  frame.wrench = grip.wrench;
  frame.stiffness = grip.stiffness;
  frame.stiffness_bound_n_per_m = grip.stiffness_bound_n_per_m;
  frame.supplied_energy_j = supplied_j_;
}

void SceneRenderer::reset() noexcept {
  contact_.reset();
  effects_.reset();
  if (body_)
    body_->body = effects::RigidBody(body_->body.shape());
  if (constrained_)
    constrained_->reset();
  series_.reset(), field_.reset();
  last_s_.reset(), potential_j_.reset(), last_position_.reset(), external_.reset();
  supplied_j_ = 0.0;
}

}  // namespace voxtouch::rendering
