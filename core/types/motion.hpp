#pragma once
/// Target of an operator's hand over time. Scenes define it; simulated devices follow it.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// A button pressed for an interval.
struct ButtonPress {
  std::uint32_t button = 0;  ///< 0 to 31
  double from_s = 0.0, to_s = 0.0;
};

/// A rotation of the hand about an axis through the device's tip: minimum jerk from rest to rest,
/// then constant.
struct MotionRotation {
  Vec3 axis = Vec3::UnitZ();        ///< unit, in the motion's frame; right-handed
  double angle_rad = 0.0;           ///< 0: none
  double from_s = 0.0, to_s = 1.0;  ///< `to_s` after `from_s`
};

/// Straight pieces between way points, each with a minimum-jerk profile of peak speed
/// `speed_m_per_s`. `repeat_from`: after the last point the target moves back and forth between the
/// points repeat_from..last; unset: it stays at the last point. Circle: after the way points the
/// target circles `circle_centre`, starting at the last point; the speed grows from rest over the
/// first quarter. A circle overrides `repeat_from`.
struct Motion {
  std::vector<Vec3> path;       ///< [m], at least one
  double speed_m_per_s = 0.05;  ///< peak speed of a straight piece, speed on the circle; > 0
  double hold_s = 0.0;          ///< rest at each way point, including the first and the last; >= 0
  std::optional<std::size_t> repeat_from;
  std::optional<Vec3>
      circle_centre;  ///< [m]; only its distance from the last point across the axis counts
  Vec3 circle_axis = Vec3::UnitZ();     ///< unit; right-handed rotation about it
  Quat orientation = Quat::Identity();  ///< constant, except for `turn`
  std::vector<ButtonPress> press = {};  ///< buttons pressed during the motion
  MotionRotation turn = {};
};

/// Buttons pressed at `time_s`; bit 0 is the first. Real-time safe.
std::uint32_t buttons_at(const Motion& motion, double time_s) noexcept;

/// Peak speed of a minimum-jerk profile over its mean speed: the derivative of 10 s^3 - 15 s^4 + 6
/// s^5 at s = 1/2.
inline constexpr double kMinimumJerkPeak = 1.875;

/// Position [m] and velocity [m/s] of the hand's target, in the motion's frame.
struct MotionPoint {
  Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
};

/// The target at `time_s`. Closed form without state, for times in any order. Time below zero or
/// NaN counts as zero, time above 1e15 s as 1e15 s. An empty path gives the frame's origin, a speed
/// that is not positive the first point. Linear in the number of way points. Real-time safe.
MotionPoint motion_at(const Motion& motion, double time_s) noexcept;

/// Orientation of the hand's target and its angular velocity [rad/s], in the motion's frame.
struct MotionOrientation {
  Quat orientation = Quat::Identity();
  Vec3 rate = Vec3::Zero();
};

/// The target's orientation at `time_s`; see motion_at. Bit-identical to `motion.orientation`
/// without a rotation. Real-time safe.
MotionOrientation orientation_at(const Motion& motion, double time_s) noexcept;

/// Time until the end of the rest at the last way point [s]; then the motion stays, repeats or
/// circles.
double approach_duration(const Motion& motion) noexcept;

/// Converts the tool's motion in W to the motion of the device's tip in D: the inverse of `T in W =
/// pose_WD * scaled(tip in D) * pose_PT`. `position_scale` > 0: metres in W for one metre of the
/// device.
Motion motion_in_device(const Motion& motion_W, const Pose& pose_WD, const Pose& pose_PT,
                        double position_scale);

}  // namespace voxtouch
