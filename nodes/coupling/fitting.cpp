#include "nodes/coupling/fitting.hpp"

#include <chrono>
#include <tuple>

#include "nodes/runtime/realtime.hpp"

namespace voxtouch::coupling_node {

namespace {

fitting::DeviceDemand demand_in(const msg::ScenePlan& plan) {
  return {.least_stiffness_n_per_m = plan.least_stiffness_n_per_m,
          .stiffest = plan.stiffest,
          .damping = {plan.effects_damping_ns_per_m, plan.largest_damping_ns_per_m, plan.largest_damping,
                      plan.largest_damping_place},
          .turning = {plan.effects_damping_nms_per_rad, plan.largest_damping_nms_per_rad, plan.largest_turning_damping,
                      plan.largest_turning_damping_place},
          .torque = plan.torque_effect,
          .external = {plan.external_force_n, plan.external_torque_nm, plan.external_effect, plan.external_place}};
}

// All members of each: one that is added does not compile before it is compared too.
auto all_of(const coupling::design::AxisModel& m) {
  const auto& [inertia_min, inertia_max, damping, friction, resolution, effort, stiffness, bandwidth] = m;
  return std::tie(inertia_min, inertia_max, damping, friction, resolution, effort, stiffness, bandwidth);
}
auto all_of(const coupling::design::LoopTiming& m) {
  const auto& [period, delay, jitter, lost, network] = m;
  return std::tie(period, delay, jitter, lost, network);
}
bool same(const coupling::design::DeviceModel& a, const coupling::design::DeviceModel& b) {
  const auto& [name_a, translation_a, rotation_a, torque_a, timing_a, grip_a] = a;
  const auto& [name_b, translation_b, rotation_b, torque_b, timing_b, grip_b] = b;
  return name_a == name_b && all_of(translation_a) == all_of(translation_b) && all_of(rotation_a) == all_of(rotation_b) && torque_a == torque_b &&
         all_of(timing_a) == all_of(timing_b) && grip_a == grip_b;
}

}  // namespace

void Fitting::set_device(const DeviceDescription& device, std::uint64_t session) {
  device_ = coupling::design::model_of(device);
  device_session_ = session;
  changed_ = outdated_ = true;
}

void Fitting::set_plan(const msg::ScenePlan& plan) {
  const rendering::StiffnessBounds bounds{{plan.one_point_stiffness_n_per_m, plan.all_points_stiffness_n_per_m},
                         {plan.one_point_stiffness_nm_per_rad, plan.all_points_stiffness_nm_per_rad}};
  outdated_ |= plan_session_ != plan.session_id || bounds != bounds_;
  bounds_ = bounds;
  demand_ = demand_in(plan);
  plan_session_ = plan.session_id;
  changed_ = true;
}

std::optional<std::uint64_t> Fitting::session() const noexcept {
  return device_session_ == plan_session_ ? device_session_ : std::nullopt;
}

fitting::FittedCoupling Fitting::fit() {
  outdated_ = false;
  if (!made_ || !same(made_->device, device_) || made_->bounds != bounds_ || made_->demand != demand_) {
    const runtime::AtOrdinaryPriority while_no_sample_waits;
    made_ = Made{device_, bounds_, demand_, fitting::fit_coupling(scene_, device_, bounds_, demand_)};
  }
  return made_->fitted;
}

void Fitting::begin() {
  outdated_ = false;
  if (under_way_.valid()) {
    again_ = true;
    return;
  }
  again_ = false;
  under_way_ =
      std::async(std::launch::async, [this, device = device_, bounds = bounds_, demand = demand_] {
        runtime::ordinary_priority();
        return fitting::fit_coupling(scene_, device, bounds, demand);
      });
}

std::optional<fitting::FittedCoupling> Fitting::poll() {
  if (!under_way_.valid() || under_way_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  fitting::FittedCoupling fitted = under_way_.get();
  fitted.refusal = judge(fitted);
  if (again_) begin();
  return fitted;
}

std::string Fitting::judge(const fitting::FittedCoupling& fitted) const {
  return fitting::judge_again(fitted, scene_, device_, bounds_.translation.one_point, demand_);
}

}  // namespace voxtouch::coupling_node
