#include "core/rendering/scene_renderer.hpp"

#include <stdexcept>

#include "core/effects/body.hpp"

namespace voxtouch::rendering {

SceneRenderer::SceneRenderer(ObjectContacts& contact, std::vector<effects::EffectSpec> effects,
                             const SceneSurroundings& surroundings)
    : contact_(contact),
      effects_(std::move(effects)),
      surroundings_(surroundings),
      has_effects_or_motion_(!effects_.empty() || contact.moves()) {
  for (std::size_t n = 0; n < effects_.size(); ++n) {
    if (!effects_.spec(n).kind->needs(effects_.spec(n).values).body)
      continue;
    if (!surroundings.body)
      throw std::invalid_argument("the effect 'body' needs the shape of the dynamic object");
    body_.emplace(BodyPart{effects::RigidBody(*surroundings.body), n});
  }
  if (surroundings.virtual_tool_lever_m)
    constrained_.emplace(contact, *surroundings.virtual_tool_lever_m,
                         surroundings.virtual_tool_work);
}

/// The contact pushes the tool where the hand has it.
SceneFrame SceneRenderer::render_pushed(const ToolState& tool, double time_s) noexcept {
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

/// The contact is the spring between hand and virtual tool, which is placed anew when the clutch is
/// pressed.
SceneFrame SceneRenderer::render_constrained(const ToolState& tool, double time_s) noexcept {
  if (tool.clutched && !clutched_)
    constrained_->reset();
  clutched_ = tool.clutched;
  const double dt_s = step_to(time_s);
  SceneFrame frame;
  const double friction =
      effects_.friction_at(constrained_->pose().position, constrained_->leans_on());
  frame.touch.contact = constrained_->render(tool.pose, time_s, dt_s, friction, frame.tool);
  const contact::ContactResult& contact = frame.touch.contact;
  frame.object = constrained_->pose();
  frame.wrench = contact.wrench;
  frame.stiffness = contact.stiffness;
  frame.stiffness_bound_n_per_m = contact.stiffness_bound_n_per_m;
  if (contact.pose_status != contact::PoseStatus::kUsable)
    return frame;
  if (!effects_.empty())
    add_effects_at_both(tool, time_s, dt_s, frame);
  supply(tool.pose, dt_s * constrained_->power_w() + constrained_->stiffened_j(), frame);
  return frame;
}

/// Effects of the surface where the virtual tool touches it, those of space where the hand is.
void SceneRenderer::add_effects_at_both(const ToolState& hand, double time_s, double dt_s,
                                        SceneFrame& frame) noexcept {
  ToolState tool = hand;
  tool.pose = frame.object, tool.twist = constrained_->twist();
  const effects::EffectFrame surface = look(tool, dt_s, time_s, constrained_->parts());
  add(effects_.apply(look(hand, dt_s, time_s, constrained_->parts()), &surface), frame);
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
  if (!effects_.empty())
    add_effects(object, time_s, dt_s, frame);
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
  add(effects_.apply(look(object, dt_s, time_s, contact_.parts(frame.touch))), frame);
}

void SceneRenderer::add(const effects::EffectPush& effects, SceneFrame& frame) noexcept {
  frame.effects = effects;
  frame.wrench.force += frame.effects.wrench.force;
  frame.wrench.torque += frame.effects.wrench.torque;
  frame.stiffness += frame.effects.stiffness;
  frame.stiffness_bound_n_per_m += frame.effects.stiffness_bound_n_per_m;
}

effects::EffectFrame SceneRenderer::look(
    const ToolState& object, double step_s, double time_s,
    std::span<const effects::ObjectContact> contacts) const noexcept {
  effects::EffectFrame in;
  in.tool = object.pose;
  in.twist = object.twist;
  in.dt_s = step_s >= kMinStepS && step_s <= kLongestStepS ? step_s : kDefaultStepS;
  in.time_s = time_s;
  in.contacts = contacts;
  in.proximity = surroundings_.proximity, in.tool_points = surroundings_.tool_points;
  in.external = external_ ? &*external_ : nullptr;
  return in;
}

/// `given_j`: by what is no effect.
void SceneRenderer::supply(const Pose& object, double given_j, SceneFrame& frame) noexcept {
  const double potential = frame.effects.potential_j;
  supplied_j_ +=
      potential_j_.value_or(potential) - potential + given_j + frame.effects.given_j +
      effects_.given_over((object.position - last_position_.value_or(object.position)).norm());
  potential_j_ = potential;
  last_position_ = object.position;
  frame.supplied_energy_j = supplied_j_;
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
  const effects::BodyGrip grip =
      body.step(load, tool.pose, tool.twist, hold, effects::grab_distance_m(values),
                effects::body_parameters(values), dt_s);
  supplied_j_ = potential_j_.value_or(body.energy_j()) - body.energy_j();
  if (!potential_j_)
    potential_j_ = body.energy_j();  // where it began
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
  clutched_ = false;
  last_s_.reset(), potential_j_.reset(), last_position_.reset(), external_.reset();
  supplied_j_ = 0.0;
}

}  // namespace voxtouch::rendering
