#include "devices/lwr/lwr_arm.hpp"

#include <numbers>

#include "devices/arm/row_turns.hpp"

namespace voxtouch::lwr {
namespace {

using arm::quarter_turns_about_x, arm::rotate_about_z;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace

LwrLimits lwr_limits() noexcept {
  LwrLimits limits;
  limits.position_rad << 170, 120, 170, 120, 170, 120, 170;
  limits.velocity_rad_s << 110, 110, 112.5, 112.5, 180, 112.5, 112.5;
  limits.torque_nm << 176, 176, 100, 100, 100, 30, 30;
  limits.position_rad *= kRadPerDeg;
  limits.velocity_rad_s *= kRadPerDeg;
  return limits;
}

LwrArm::State LwrArm::at(const LwrJoints& q) const noexcept {
  State state;
  for (int i = 0; i < kJoints; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Pose row{Vec3(0.0, 0.0, kD[n]),
                   rotate_about_z(q[i]) * quarter_turns_about_x(kAlphaQuarterTurns[n])};
    state.links[n + 1] = state.links[n] * row;
  }
  state.pose_BT = state.links.back() * pose_FT_;
  for (int i = 0; i < kJoints; ++i) {
    // Joint i rotates about the z axis of frame i.
    const Pose& before = state.links[static_cast<std::size_t>(i)];
    const Vec3 axis = before.orientation * Vec3::UnitZ();
    state.jacobian.col(i) << axis.cross(state.pose_BT.position - before.position), axis;
  }
  return state;
}

const arm::ArmDescription& lwr_description() {
  static const arm::ArmDescription description = [] {
    constexpr std::array<std::string_view, LwrArm::kJoints> kNames = {"A1", "A2", "E1", "A3",
                                                                      "A4", "A5", "A6"};
    const LwrLimits limits = lwr_limits();
    arm::ArmDescription arm{.model = "lwr", .joints = {}, .flange = {}};
    Pose after;  // from the last joint, at an angle of 0, to the next one
    for (int i = 0; i < LwrArm::kJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const double most = limits.position_rad[i];
      arm.joints.push_back(
          {kNames[n], after, -most, most, limits.velocity_rad_s[i], limits.torque_nm[i]});
      after = {Vec3(0.0, 0.0, LwrArm::kD[n]), quarter_turns_about_x(LwrArm::kAlphaQuarterTurns[n])};
    }
    arm.flange = after;
    return arm;
  }();
  return description;
}

LwrJoints lwr_rest_posture() noexcept {
  LwrJoints q;
  q << 0, 30, 0, -90, 0, 60, 0;
  return q * kRadPerDeg;
}

}  // namespace voxtouch::lwr
