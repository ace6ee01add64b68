#include "nodes/coupling/fitting.hpp"

#include <sched.h>

#include <chrono>

#include "nodes/runtime/device_model.hpp"

namespace voxtouch::coupling {

void Fitting::take(const msg::DeviceDescription& device) {
  device_ = runtime::model_of(device, device.simulated);
  parse_grip(device.grip, grip_);
  device_session_ = device.session_id;
  changed_ = true;
}

void Fitting::take(const msg::ScenePlan& plan) {
  translation_ = {plan.one_point_stiffness_n_per_m, plan.all_points_stiffness_n_per_m};
  rotation_ = {plan.one_point_stiffness_nm_per_rad, plan.all_points_stiffness_nm_per_rad};
  plan_session_ = plan.session_id;
  changed_ = true;
}

std::optional<std::uint64_t> Fitting::session() const noexcept {
  return device_session_ == plan_session_ ? device_session_ : std::nullopt;
}

FittedCoupling Fitting::fit() const { return fit_coupling(scene_, device_, grip_, translation_, rotation_); }

void Fitting::begin() {
  if (under_way_.valid()) {
    again_ = true;
    return;
  }
  again_ = false;
  under_way_ = std::async(
      std::launch::async, [this, device = device_, grip = grip_, translation = translation_, rotation = rotation_] {
        const sched_param ordinary{};
        sched_setscheduler(0, SCHED_OTHER, &ordinary);  // the loop, which starts this thread, may run under SCHED_FIFO
        return fit_coupling(scene_, device, grip, translation, rotation);
      });
}

std::optional<FittedCoupling> Fitting::poll() {
  if (!under_way_.valid() || under_way_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return std::nullopt;
  FittedCoupling fitted = under_way_.get();
  if (again_) begin();
  return fitted;
}

}  // namespace voxtouch::coupling
