#include "core/rendering/device_mapping.hpp"

namespace voxtouch::rendering {
namespace {

/// Larger positions [m] are faults, and their sums could overflow.
constexpr double kFarthestM = 1e12;

/// From the tip to the tool's origin, W axes; the offset is given in the frame of the tip.
Vec3 arm_PT_W(const scene::WorkspaceMapping& spec, const Quat& rotation_WT) noexcept {
  return rotation_WT * (spec.pose_PT.orientation.conjugate() * spec.pose_PT.position);
}

}  // namespace

Wrench wrench_to_device(const scene::WorkspaceMapping& spec, const Wrench& wrench_W,
                        const Quat& rotation_WT) noexcept {
  const Quat rotation_DW = spec.pose_WD.orientation.conjugate();
  const Vec3 torque_P_W = wrench_W.torque + arm_PT_W(spec, rotation_WT).cross(wrench_W.force);
  return {spec.force_scale * (rotation_DW * wrench_W.force),
          spec.force_scale / spec.position_scale * (rotation_DW * torque_P_W)};
}

Wrench WrenchToDevice::operator()(const Wrench& wrench_W, const Quat& rotation_WT) noexcept {
  if (Quat unit = rotation_WT; normalise_within(unit, 1.0 - 1e-3, 1.0 + 1e-3))
    last_rotation_WT_ = rotation_WT;
  return wrench_to_device(spec_, wrench_W, last_rotation_WT_);
}

const ToolState& DeviceMapping::update(const Pose& pose_DP, const Twist& twist_D,
                                       std::uint32_t buttons) noexcept {
  Pose tip = pose_DP;
  const bool unit = normalise_within(tip.orientation, 1.0 - 1e-3, 1.0 + 1e-3);
  // The tip in W without the clutch offset.
  const Pose& pose_WD = spec_.pose_WD;
  const Pose free_WP = pose_WD * Pose{spec_.position_scale * tip.position, tip.orientation};
  tool_.refused = !unit || !(free_WP.position.cwiseAbs().array() <= kFarthestM).all();
  if (tool_.refused) {
    tool_.twist = {};
    return tool_;
  }
  const bool pressed = spec_.clutch_button && ((buttons >> *spec_.clutch_button) & 1U) != 0U;
  if (pressed && !tool_.clutched)
    clutched_WP_ = seen_ ? tool_.pose * spec_.pose_PT.inverse() : free_WP;
  if (!pressed && tool_.clutched) {
    shift_W_ = clutched_WP_.position - free_WP.position;
    rotation_P_ = (free_WP.orientation.conjugate() * clutched_WP_.orientation).normalized();
  }
  const Pose now_WP =
      pressed ? clutched_WP_ : Pose{free_WP.position + shift_W_, free_WP.orientation * rotation_P_};
  tool_.clutched = pressed;
  tool_.buttons = buttons;
  seen_ = true;
  tool_.pose = now_WP * spec_.pose_PT;
  tool_.pose.orientation.normalize();
  tool_.twist = {};
  if (!pressed && twist_D.finite()) {
    tool_.twist.angular = pose_WD.orientation * twist_D.angular;
    tool_.twist.linear = spec_.position_scale * (pose_WD.orientation * twist_D.linear) +
                         tool_.twist.angular.cross(arm_PT_W(spec_, tool_.pose.orientation));
    if (!tool_.twist.finite())
      tool_.twist = {};  // it was still in the units of the device
  }
  return tool_;
}

}  // namespace voxtouch::rendering
