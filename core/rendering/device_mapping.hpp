#pragma once
/// How the device moves the tool in the world, and how the contact comes back to the hand.
///
///   pose_WT = pose_WD * scaled(pose_DP) * pose_PT
///
/// `scaled` multiplies the tip's position by position_scale s and leaves its orientation. What goes
/// out of W is the wrench about the tool's origin; what the device takes is the wrench about its
/// tip, in D. With force_scale f:
///
///   force_D  = f R^T force_W,    torque_D = (f / s) R^T (torque_W + arm x force_W),   arm = tip ->
///   tool's origin, W axes.
///
/// The torque carries f / s because a lever in W is s times as long as in the hand. With it one
/// rule holds for every motion: power at the hand = (f / s) * power in W, so a passive scene stays
/// passive through any pair of scales. A stiffness against translation is displayed times s f, one
/// against rotation times f / s: the same contact at levers 1 / s as long.
#include <cstdint>

#include "core/scene/scene.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::rendering {

/// Wrench about the tool's origin in W to wrench about the device's tip in D. `rotation_WT` is the
/// tool's orientation that the wrench was computed for. Real-time safe.
Wrench wrench_to_device(const scene::WorkspaceMapping& spec, const Wrench& wrench_W,
                        const Quat& rotation_WT) noexcept;

/// The same from sample to sample: an orientation that is none (not finite, no unit quaternion
/// within 1e-3) must not make the command none, so the tool is taken to be turned as it was last.
/// Real-time safe.
class WrenchToDevice {
 public:
  /// The tool is not turned until a first orientation has come.
  explicit WrenchToDevice(const scene::WorkspaceMapping& spec) noexcept : spec_(spec) {}
  /// As `wrench_to_device`, for the wrench of this sample [N, Nm].
  Wrench operator()(const Wrench& wrench_W, const Quat& rotation_WT) noexcept;

 private:
  scene::WorkspaceMapping spec_;
  Quat last_rotation_WT_ = Quat::Identity();
};

/// The tool as the device holds it.
struct ToolState {
  Pose pose;              ///< T in W [m]
  Twist twist;            ///< of the tool's origin, W axes; zero while clutched
  bool clutched = false;  ///< the button is pressed: the tool stays, the device moves free and is
                          ///< to feel nothing
  std::uint32_t buttons = 0;  ///< of the device, bit 0 the first
  bool refused = false;  ///< the sample was not usable (not finite, no unit quaternion); the last
                         ///< pose was kept
};

/// Follows one device through its clutch. While the button is pressed the tool stays; on release it
/// goes on from there: the hand's translation since is taken off, and the hand's rotation since is
/// taken off on the tool's side, so that a turn of the hand about an axis of the world still turns
/// the tool about that axis. Real-time safe, deterministic.
class DeviceMapping {
 public:
  /// `spec` as the scene's reader accepts it.
  explicit DeviceMapping(const scene::WorkspaceMapping& spec) noexcept : spec_(spec) {}

  /// One sample: tip in D, its twist in D axes, buttons (bit 0 = first). A norm of the quaternion
  /// within 1e-3 of 1 is normalised, any other refuses the sample. A twist that is not finite reads
  /// as zero.
  const ToolState& update(const Pose& pose_DP, const Twist& twist_D,
                          std::uint32_t buttons) noexcept;

  const ToolState& tool() const noexcept { return tool_; }
  /// Forgets the clutch's offset and the last sample: a new device session.
  void reset() noexcept { *this = DeviceMapping(spec_); }

 private:
  scene::WorkspaceMapping spec_;
  Vec3 shift_W_ = Vec3::Zero();         ///< clutch: added to the tip's position in W
  Quat rotation_P_ = Quat::Identity();  ///< clutch: tip orientation in W is followed by this
  Pose clutched_WP_;                    ///< tip in W while clutched
  bool seen_ = false;
  ToolState tool_;
};

}  // namespace voxtouch::rendering
