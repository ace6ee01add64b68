#include "core/rendering/live_scene.hpp"

#include <utility>

namespace voxtouch::rendering {
namespace {

Wrench blend(const Wrench& a, const Wrench& b, double w) noexcept {
  return {(1.0 - w) * a.force + w * b.force, (1.0 - w) * a.torque + w * b.torque};
}

/// Weighted sum of both; values that cannot be blended are those of `reported`.
SceneFrame blend(const SceneFrame& a, const SceneFrame& b, double w) noexcept {
  const auto mix = [w](double x, double y) { return (1.0 - w) * x + w * y; };
  SceneFrame frame = w < 0.5 ? a : b;
  const contact::ContactResult &one = a.touch.contact, &two = b.touch.contact;
  contact::ContactResult& contact = frame.touch.contact;
  contact.wrench = blend(one.wrench, two.wrench, w);
  contact.stiffness = (1.0 - w) * one.stiffness + w * two.stiffness;
  contact.stiffness_bound_n_per_m = mix(one.stiffness_bound_n_per_m, two.stiffness_bound_n_per_m);
  frame.effects.wrench = blend(a.effects.wrench, b.effects.wrench, w);
  frame.effects.stiffness = (1.0 - w) * a.effects.stiffness + w * b.effects.stiffness;
  frame.effects.stiffness_bound_n_per_m =
      mix(a.effects.stiffness_bound_n_per_m, b.effects.stiffness_bound_n_per_m);
  frame.effects.potential_j = mix(a.effects.potential_j, b.effects.potential_j);
  frame.wrench = blend(a.wrench, b.wrench, w);
  frame.stiffness = (1.0 - w) * a.stiffness + w * b.stiffness;
  frame.stiffness_bound_n_per_m = mix(a.stiffness_bound_n_per_m, b.stiffness_bound_n_per_m);
  return frame;
}

}  // namespace

void LiveScene::advance(double time_s) noexcept {
  const double step = last_s_ < 0.0 ? SceneRenderer::kDefaultStepS : time_s - last_s_;
  const bool usual = step >= SceneRenderer::kMinStepS && step <= SceneRenderer::kLongestStepS;
  weight_ += (usual ? step : SceneRenderer::kDefaultStepS) / kFadeS;
  if (weight_ > 1.0 - 1e-9)
    weight_ = 1.0;  // rounding must not add another sample
}

SceneFrame LiveScene::render(const ToolState& tool, double time_s) noexcept {
  if (series_.returns_torque() || tool.clutched || now_->scene_renderer().grips_a_body()) {
    latched_rotation_.reset();
    return render_scenes(tool, time_s);
  }
  const double step = last_s_ < 0.0 ? SceneRenderer::kDefaultStepS : time_s - last_s_;
  ToolState held = tool;
  held.pose.orientation = latched_rotation_.follow(tool.pose.orientation, step);
  SceneFrame frame = render_scenes(held, time_s);
  latched_rotation_.set_torque(frame.touch.contact.wrench.torque);
  return frame;
}

SceneFrame LiveScene::render_scenes(const ToolState& tool, double time_s) noexcept {
  if (!fading()) {
    last_s_ = time_s;
    SceneFrame frame = now_->scene_renderer().render(tool, time_s);
    supplied_j_ +=
        frame.supplied_energy_j - std::exchange(supplied_now_j_, frame.supplied_energy_j);
    frame.supplied_energy_j = supplied_j_;
    return frame;
  }
  advance(time_s);
  last_s_ = time_s;
  const SceneFrame before = old_->scene_renderer().render(tool, time_s);
  const SceneFrame after = now_->scene_renderer().render(tool, time_s);
  dominant_ = weight_ < 0.5 ? old_ : now_;
  SceneFrame frame = blend(before, after, weight_);
  // The supplied energy of each scene is weighted like its force.
  supplied_j_ +=
      (1.0 - weight_) *
          (before.supplied_energy_j - std::exchange(supplied_old_j_, before.supplied_energy_j)) +
      weight_ * (after.supplied_energy_j - std::exchange(supplied_now_j_, after.supplied_energy_j));
  frame.supplied_energy_j = supplied_j_;
  if (weight_ >= 1.0)
    finish();
  return frame;
}

void LiveScene::swap_to(BuiltScene& next) noexcept {
  old_ = std::exchange(now_, &next);
  now_->scene_renderer().set_spring_target(spring_n_per_m_);
  now_->scene_renderer().set_series_target(series_);
  if (external_)
    now_->scene_renderer().set_external_wrench(*external_);
  now_->scene_renderer().start_tool_from(old_->scene_renderer(), last_s_ < 0.0 ? 0.0 : last_s_);
  supplied_old_j_ = std::exchange(supplied_now_j_, 0.0);
  weight_ = 0.0;
}

void LiveScene::set_spring_target(double n_per_m) noexcept {
  if (n_per_m == spring_n_per_m_)
    return;
  spring_n_per_m_ = n_per_m;
  for (BuiltScene* scene : {now_, old_})
    if (scene != nullptr)
      scene->scene_renderer().set_spring_target(n_per_m);
}

void LiveScene::set_series_target(const Compliance& spring) noexcept {
  if (spring == series_)
    return;
  series_ = spring;
  for (BuiltScene* scene : {now_, old_})
    if (scene != nullptr)
      scene->scene_renderer().set_series_target(spring);
}

void LiveScene::set_external_wrench(const effects::ExternalWrench& newest) noexcept {
  external_ = newest;
  for (BuiltScene* scene : {now_, old_})
    if (scene != nullptr)
      scene->scene_renderer().set_external_wrench(newest);
}

void LiveScene::reset_virtual_tool() noexcept {
  for (BuiltScene* scene : {now_, old_})
    if (scene != nullptr)
      scene->scene_renderer().reset_virtual_tool();
}

void LiveScene::finish() noexcept {
  if (!fading())
    return;
  retired_ = std::exchange(old_, nullptr);
  dominant_ = now_;
  weight_ = 1.0;
}

void LiveScene::reset() noexcept {
  finish();
  now_->scene_renderer().reset();
  latched_rotation_.reset();
  last_s_ = -1.0;
  external_.reset();
  supplied_j_ = supplied_now_j_ = supplied_old_j_ = 0.0;
}

BuiltScene* LiveScene::retired() noexcept { return std::exchange(retired_, nullptr); }

}  // namespace voxtouch::rendering
