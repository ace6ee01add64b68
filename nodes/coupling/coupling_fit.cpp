#include "nodes/coupling/coupling_fit.hpp"

#include <chrono>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::coupling_node {

namespace {

device_fit::SceneRequirements demand_in(const msg::ScenePlan& plan) {
  return {.least_stiffness_n_per_m = plan.least_stiffness_n_per_m,
          .stiffest = plan.stiffest,
          .damping = {plan.effects_damping_ns_per_m, plan.largest_damping_ns_per_m,
                      plan.largest_damping, plan.largest_damping_place},
          .rotation = {plan.effects_damping_nms_per_rad, plan.largest_damping_nms_per_rad,
                       plan.largest_rotation_damping, plan.largest_rotation_damping_place},
          .torque = plan.torque_effect,
          .external = {plan.external_force_n, plan.external_torque_nm, plan.external_effect,
                       plan.external_place}};
}

}  // namespace

void Fitting::set_device(const DeviceDescription& device, std::uint64_t session) {
  device_ = coupling::design::model_of(device);
  device_session_ = session;
  changed_ = outdated_ = true;
}

void Fitting::set_plan(const msg::ScenePlan& plan) {
  const rendering::StiffnessBounds bounds{
      {plan.one_point_stiffness_n_per_m, plan.all_points_stiffness_n_per_m},
      {plan.one_point_stiffness_nm_per_rad, plan.all_points_stiffness_nm_per_rad}};
  outdated_ |= plan_session_ != plan.session_id || bounds != bounds_;
  bounds_ = bounds;
  demand_ = demand_in(plan);
  voxel_size_m_ = plan.voxel_size_m;
  plan_session_ = plan.session_id;
  changed_ = true;
}

std::optional<std::uint64_t> Fitting::session() const noexcept {
  return device_session_ == plan_session_ ? device_session_ : std::nullopt;
}

device_fit::FittedCoupling Fitting::fit() {
  outdated_ = false;
  const runtime::AtOrdinaryPriority while_no_sample_waits;
  return device_fit::fit_coupling(scene_, device_, bounds_, demand_);
}

void Fitting::begin() {
  outdated_ = false;
  if (pending_.valid()) {
    again_ = true;
    return;
  }
  again_ = false;
  pending_ =
      std::async(std::launch::async, [this, device = device_, bounds = bounds_, demand = demand_] {
        runtime::ordinary_priority();
        return device_fit::fit_coupling(scene_, device, bounds, demand);
      });
}

std::optional<device_fit::FittedCoupling> Fitting::poll() {
  if (!pending_.valid() || pending_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  device_fit::FittedCoupling fitted = pending_.get();
  fitted.refusal = judge(fitted);
  if (again_)
    begin();
  return fitted;
}

device_fit::Refusal Fitting::judge(const device_fit::FittedCoupling& fitted) const {
  return device_fit::judge_again(fitted, scene_, device_, bounds_.translation.one_point, demand_);
}

}  // namespace voxtouch::coupling_node
