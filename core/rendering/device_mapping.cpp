#include "core/rendering/device_mapping.hpp"

namespace voxtouch::rendering {
namespace {

/// Beyond this [m] a pose is no place but a fault: sums of such places could overflow.
constexpr double kFarthestM = 1e12;

/// From the tip to the tool's origin, W axes: the offset is given in the tip's frame.
Vec3 arm_of(const scene::WorkspaceMapping& spec, const Quat& tool_in_world) noexcept {
  return tool_in_world * (spec.tool_offset.orientation.conjugate() * spec.tool_offset.position);
}

}  // namespace

Wrench wrench_to_device(const scene::WorkspaceMapping& spec, const Wrench& in_world, const Quat& tool_in_world) noexcept {
  const Quat to_device = spec.device_in_world.orientation.conjugate();
  const Vec3 torque_at_tip = in_world.torque + arm_of(spec, tool_in_world).cross(in_world.force);
  return {spec.force_scale * (to_device * in_world.force),
          spec.force_scale / spec.position_scale * (to_device * torque_at_tip)};
}

Wrench WrenchToDevice::operator()(const Wrench& in_world, const Quat& tool_in_world) noexcept {
  if (Quat unit = tool_in_world; normalise_within(unit, 1.0 - 1e-3, 1.0 + 1e-3)) last_tool_in_world_ = tool_in_world;
  return wrench_to_device(spec_, in_world, last_tool_in_world_);
}

const ToolState& DeviceMapping::update(const Pose& tip_in_device, const Twist& twist_in_device,
                                       std::uint32_t buttons) noexcept {
  Pose tip = tip_in_device;
  const bool turned = normalise_within(tip.orientation, 1.0 - 1e-3, 1.0 + 1e-3);
  // The tip in W as it would be without the clutch.
  const Pose& base = spec_.device_in_world;
  const Pose free = base * Pose{spec_.position_scale * tip.position, tip.orientation};
  tool_.refused = !turned || !(free.position.cwiseAbs().array() <= kFarthestM).all();
  if (tool_.refused) {
    tool_.twist = {};
    return tool_;
  }
  const bool pressed = spec_.clutch_button && ((buttons >> *spec_.clutch_button) & 1U) != 0U;
  if (pressed && !tool_.clutched) held_ = seen_ ? tool_.pose * spec_.tool_offset.inverse() : free;
  if (!pressed && tool_.clutched) {
    shift_ = held_.position - free.position;
    turn_ = (free.orientation.conjugate() * held_.orientation).normalized();
  }
  const Pose now = pressed ? held_ : Pose{free.position + shift_, free.orientation * turn_};
  tool_.clutched = pressed;
  tool_.buttons = buttons;
  seen_ = true;
  tool_.pose = now * spec_.tool_offset;
  tool_.pose.orientation.normalize();
  tool_.twist = {};
  if (!pressed && twist_in_device.finite()) {
    tool_.twist.angular = base.orientation * twist_in_device.angular;
    tool_.twist.linear = spec_.position_scale * (base.orientation * twist_in_device.linear) +
                         tool_.twist.angular.cross(arm_of(spec_, tool_.pose.orientation));
    if (!tool_.twist.finite()) tool_.twist = {};  // in the device's units it still was
  }
  return tool_;
}

}  // namespace voxtouch::rendering
