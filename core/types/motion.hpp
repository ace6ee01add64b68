#pragma once
/// Where an operator's hand wants the tool to be: a value that scenes name and simulated devices follow.
#include <optional>
#include <vector>

#include "core/types/geometry.hpp"

namespace voxtouch {

/// Straight pieces between way points, each walked with a minimum-jerk profile whose peak speed is `speed_m_per_s`.
/// `repeat_from`: after the last point the hand walks back and forth between points repeat_from..last for ever; absent: it
/// holds the last point. Circle: after the way points the hand goes round `centre` for ever (start of the circle = last point).
struct Motion {
  std::vector<Vec3> path;               ///< [m], at least one
  double speed_m_per_s = 0.05;          ///< peak speed, > 0
  double hold_s = 0.0;                  ///< rest at each way point
  std::optional<std::size_t> repeat_from;
  std::optional<Vec3> circle_centre;    ///< [m]
  Vec3 circle_axis = Vec3::UnitZ();     ///< unit
  Quat orientation = Quat::Identity();  ///< kept throughout
};

/// Position and velocity of the hand's target at `time_s` >= 0. Closed form, no state: any time may be asked.
struct MotionPoint { Vec3 position = Vec3::Zero(), velocity = Vec3::Zero(); };
MotionPoint motion_at(const Motion& motion, double time_s) noexcept;

/// The same motion seen from another frame: x' = pose.inverse() * x / scale.
Motion motion_in_device(const Motion& in_world, const Pose& device_in_world, const Pose& tool_offset, double position_scale);

}  // namespace voxtouch
