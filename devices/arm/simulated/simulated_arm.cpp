#include "devices/arm/simulated/simulated_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace voxtouch::arm_sim {

void require(bool good, const char* field, const char* rule) {
  if (!good)
    throw std::runtime_error(fmt::format("simulated controller: {} must be {}", field, rule));
}

void ArmConfig::validate() const {
  require(plant.pose_FT.finite(), "the tool", "finite");
  require(start_rad.allFinite() && (start_rad.array() <= plant.highest_rad.array()).all() &&
              (start_rad.array() >= plant.lowest_rad.array()).all(),
          "start_rad", "within the joints' limits");
  require(torque_lag_s >= 0.0 && torque_lag_s < 1.0, "torque_lag_s", "in [0, 1)");
  require(torque_delay_ticks >= 0 && torque_delay_ticks <= kMaxDelayTicks, "torque_delay_ticks",
          "in [0, 100]");
}

SimulatedArm::SimulatedArm(const ArmConfig& config, hand::Hand hand, FaultSchedule faults)
    : plant_(config.plant, config.start_rad),
      hand_(std::move(hand)),
      faults_(std::move(faults)),
      hand_holds_(!config.hand_waits),
      angle_resolution_rad_(config.angle_resolution_rad),
      // Pade(1,1) of 1 - exp(-dt / lag): independent of the math library.
      follow_(std::min(1.0, kSubstep / (config.torque_lag_s + 0.5 * kSubstep))),
      delay_(static_cast<std::size_t>(config.torque_delay_ticks)) {
  line_.fill(arm::Joints::Zero());
}

arm::Joints SimulatedArm::measured_rad() const noexcept {
  const double step = angle_resolution_rad_;
  return step > 0.0 ? arm::Joints(plant_.q().unaryExpr(
                          [step](double x) { return std::round(x / step) * step; }))
                    : plant_.q();
}

void SimulatedArm::drop_torque() noexcept {
  line_.fill(arm::Joints::Zero());
  torque_.setZero();
}

}  // namespace voxtouch::arm_sim
