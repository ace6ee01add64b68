#pragma once
/// Maps device poses to the tool in the world, and contact wrenches back to the device.
///
///     pose_WT = pose_WD * scaled(pose_DP) * pose_PT
///
/// `scaled` multiplies the position of the tip by position_scale s and keeps its orientation. The
/// wrench in W acts at the tool's origin; the device takes the wrench at its tip, in D. With
/// force_scale f and arm from the tip to the tool's origin, W axes:
///
///     force_D  = f R^T force_W
///     torque_D = (f / s) R^T (torque_W + arm x force_W)
///
/// The torque has the factor f / s because a lever in W is s times as long as at the hand. One rule
/// then holds for every motion: power at the hand = (f / s) * power in W. A passive scene therefore
/// stays passive for any pair of scales. Translational stiffness is displayed times s f and
/// rotational stiffness times f / s, which is the same contact at levers 1 / s as long.
#include <cstdint>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// Converts a wrench about the tool's origin in W to a wrench about the device's tip in D.
/// `rotation_WT` is the orientation of the tool that the wrench was computed for. Real-time safe.
Wrench wrench_to_device(const scene::WorkspaceMapping& spec, const Wrench& wrench_W,
                        const Quat& rotation_WT) noexcept;

/// The same from sample to sample. An invalid orientation (not finite, or not a unit quaternion
/// within 1e-3) must not void the command, so the last valid one is used. Real-time safe.
class WrenchToDevice {
 public:
  /// The tool has the identity orientation until the first valid one.
  explicit WrenchToDevice(const scene::WorkspaceMapping& spec) noexcept : spec_(spec) {}
  /// As `wrench_to_device`, for the wrench of this sample [N, Nm].
  Wrench operator()(const Wrench& wrench_W, const Quat& rotation_WT) noexcept;

 private:
  scene::WorkspaceMapping spec_;
  Quat last_rotation_WT_ = Quat::Identity();
};

/// Tool state derived from the device.
struct ToolState {
  Pose pose;    ///< T in W [m]
  Twist twist;  ///< of the tool's origin, W axes; zero while clutched
  /// The button is pressed: the tool stays in place, and the device moves freely without force.
  bool clutched = false;
  std::uint32_t buttons = 0;  ///< of the device; bit 0 is the first
  /// The sample was invalid (not finite, or not a unit quaternion); the last pose was kept.
  bool refused = false;
};

/// Follows a device with a clutch. Real-time safe, deterministic.
/// While the button is pressed the tool stays in place; on release it continues from there. The
/// translation of the hand in between is subtracted in W. Its rotation is subtracted on the tool's
/// side, so that a rotation of the hand about an axis of the world still rotates the tool about
/// that axis.
class DeviceMapping {
 public:
  /// Requires a `spec` as accepted by the reader of scenes.
  explicit DeviceMapping(const scene::WorkspaceMapping& spec) noexcept : spec_(spec) {}

  /// Processes one sample: tip in D, its twist in D axes, buttons (bit 0 = first). A quaternion
  /// norm within 1e-3 of 1 is normalised; any other refuses the sample. A non-finite twist counts
  /// as zero.
  const ToolState& update(const Pose& pose_DP, const Twist& twist_D,
                          std::uint32_t buttons) noexcept;

  const ToolState& tool() const noexcept { return tool_; }
  /// Forgets the clutch offset and the last sample, for a new device session.
  void reset() noexcept { *this = DeviceMapping(spec_); }

 private:
  scene::WorkspaceMapping spec_;
  Vec3 shift_W_ = Vec3::Zero();         ///< clutch: added to the tip's position in W
  Quat rotation_P_ = Quat::Identity();  ///< clutch: applied after the tip's orientation in W
  Pose clutched_WP_;                    ///< tip in W while clutched
  bool seen_ = false;
  ToolState tool_;
};

}  // namespace voxtouch::rendering
