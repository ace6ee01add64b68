#include "devices/fr3/fr3_arm.hpp"

#include <numbers>

#include "devices/arm/row_turns.hpp"

namespace voxtouch::fr3 {

using arm::quarter_turns_about_x, arm::rotate_about_z;

Fr3Limits fr3_limits() noexcept {
  Fr3Limits limits;
  limits.lowest_rad << -2.8973, -1.7837, -2.9007, -3.0718, -2.8973, -0.0175, -3.0159;
  limits.highest_rad << 2.8973, 1.7837, 2.9007, -0.0698, 2.8973, 4.5169, 3.0159;
  limits.velocity_rad_s << 2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26;
  limits.torque_nm << 87, 87, 87, 87, 12, 12, 12;
  return limits;
}

Fr3Arm::State Fr3Arm::at(const Joints& q) const noexcept {
  State state;
  std::array<Pose, kJoints> frames;
  Pose frame;
  for (int i = 0; i < kJoints; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Pose to_axis{Vec3(kA[n], 0.0, 0.0), quarter_turns_about_x(kAlphaQuarterTurns[n])};
    frame = frame * to_axis * Pose{Vec3(0.0, 0.0, kD[n]), rotate_about_z(q[i])};
    frames[n] = frame;
  }
  state.flange = frame * Pose{Vec3(0.0, 0.0, kFlange), Quat::Identity()};
  state.pose_BT = state.flange * pose_FT_;
  for (int i = 0; i < kJoints; ++i) {
    // Joint i rotates about the z axis of frame i.
    const Pose& own = frames[static_cast<std::size_t>(i)];
    const Vec3 axis = own.orientation * Vec3::UnitZ();
    state.jacobian.col(i) << axis.cross(state.pose_BT.position - own.position), axis;
  }
  return state;
}

const arm::ArmDescription& fr3_description() {
  static const arm::ArmDescription description = [] {
    constexpr std::array<std::string_view, Fr3Arm::kJoints> kNames = {
        "fr3_joint1", "fr3_joint2", "fr3_joint3", "fr3_joint4",
        "fr3_joint5", "fr3_joint6", "fr3_joint7"};
    const Fr3Limits limits = fr3_limits();
    arm::ArmDescription arm{.model = "fr3",
                            .joints = {},
                            .flange = {Vec3(0.0, 0.0, Fr3Arm::kFlange), Quat::Identity()}};
    for (int i = 0; i < Fr3Arm::kJoints; ++i) {
      const auto n = static_cast<std::size_t>(i);
      const Pose to_axis{Vec3(Fr3Arm::kA[n], 0.0, 0.0),
                         quarter_turns_about_x(Fr3Arm::kAlphaQuarterTurns[n])};
      arm.joints.push_back({kNames[n],
                            to_axis * Pose{Vec3(0.0, 0.0, Fr3Arm::kD[n]), Quat::Identity()},
                            limits.lowest_rad[i], limits.highest_rad[i], limits.velocity_rad_s[i],
                            limits.torque_nm[i]});
    }
    return arm;
  }();
  return description;
}

Joints fr3_rest_posture() noexcept {
  Joints q;
  q << 0, -45, 0, -135, 0, 90, 45;
  return q * (std::numbers::pi / 180.0);
}

}  // namespace voxtouch::fr3
