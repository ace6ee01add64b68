#include "core/scene/scene_renderer.hpp"

#include <array>

namespace voxtouch {

SceneFrame SceneRenderer::render(const ToolState& tool, double time_s) noexcept {
  SceneFrame frame;
  frame.touch = contact_.render(tool.pose);
  const ContactResult& contact = frame.touch.contact;
  frame.wrench = contact.wrench;
  frame.stiffness = contact.stiffness;
  frame.stiffness_bound_n_per_m = contact.stiffness_bound_n_per_m;
  if (!effects_.empty() && contact.pose_status == PoseStatus::kUsable) add_effects(tool, time_s, frame);
  return frame;
}

void SceneRenderer::add_effects(const ToolState& tool, double time_s, SceneFrame& frame) noexcept {
  const double step = last_s_ ? time_s - *last_s_ : kUsualStepS;
  last_s_ = time_s;
  const std::array contacts = {ObjectContact{.object = 0, .contact = &frame.touch.contact, .twist = {}}};
  frame.effects = effects_.apply(look(tool, step, time_s, contacts));
  frame.wrench.force += frame.effects.wrench.force;
  frame.wrench.torque += frame.effects.wrench.torque;
  frame.stiffness += frame.effects.stiffness;
  frame.stiffness_bound_n_per_m += frame.effects.stiffness_bound_n_per_m;
}

EffectFrame SceneRenderer::look(const ToolState& tool, double step_s, double time_s,
                                std::span<const ObjectContact> contacts) const noexcept {
  EffectFrame in;
  in.tool = tool.pose;
  in.twist = tool.twist;
  in.dt_s = step_s >= kLeastStepS && step_s <= kLongestStepS ? step_s : kUsualStepS;
  in.time_s = time_s;
  in.contacts = contacts;
  return in;
}

void SceneRenderer::reset() noexcept {
  contact_.reset();
  effects_.reset();
  last_s_.reset();
}

}  // namespace voxtouch
