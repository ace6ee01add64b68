#include "core/types/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch {
namespace {

constexpr double kLatest = 1e15;  // [s]; beyond it a double does not resolve fractions of a second

double usable_time(double time_s) noexcept {
  return time_s > 0.0 ? std::min(time_s, kLatest) : 0.0;
}

double walk_duration(const Motion& motion, std::size_t from, std::size_t to) noexcept {
  return kMinimumJerkPeak * (motion.path[to] - motion.path[from]).norm() / motion.speed_m_per_s;
}

/// Minimum jerk: rest to rest, acceleration zero at both ends. Fraction of the path and its rate
/// [1/s].
struct Profile {
  double fraction, rate;
};
Profile minimum_jerk(double time_s, double duration_s) noexcept {
  const double s = time_s / duration_s;
  return {s * s * s * (10.0 + s * (-15.0 + 6.0 * s)),
          30.0 * s * s * (1.0 - s) * (1.0 - s) / duration_s};
}

/// Moves from one way point to another.
MotionPoint walk(const Motion& motion, std::size_t from, std::size_t to, double time_s,
                 double duration_s) noexcept {
  const auto [fraction, rate] = minimum_jerk(time_s, duration_s);
  const Vec3 displacement = motion.path[to] - motion.path[from];
  return {motion.path[from] + fraction * displacement, rate * displacement};
}

MotionPoint rest_at(const Motion& motion, std::size_t point) noexcept {
  return {motion.path[point], Vec3::Zero()};
}

/// Visits from..to (in either direction), with a rest after each piece. Subtracts the used time
/// from `time_s`; true if the motion is still in this stretch.
bool stretch(const Motion& motion, std::size_t from, std::size_t to, double& time_s,
             MotionPoint& out) noexcept {
  for (std::size_t at = from; at != to;) {
    const std::size_t next = to > at ? at + 1 : at - 1;
    const double duration = walk_duration(motion, at, next);
    if (time_s < duration)
      return out = walk(motion, at, next, time_s, duration), true;
    time_s -= duration;
    if (time_s < motion.hold_s)
      return out = rest_at(motion, next), true;
    time_s -= motion.hold_s;
    at = next;
  }
  return false;
}

double stretch_duration(const Motion& motion, std::size_t from, std::size_t to) noexcept {
  double sum = 0.0;
  for (std::size_t at = from; at < to; ++at)
    sum += walk_duration(motion, at, at + 1) + motion.hold_s;
  return sum;
}

MotionPoint back_and_forth(const Motion& motion, std::size_t first, double time_s) noexcept {
  const std::size_t last = motion.path.size() - 1;
  const double period = 2.0 * stretch_duration(motion, first, last);
  if (!(period > 0.0))
    return rest_at(motion, last);
  time_s = std::fmod(time_s, period);
  MotionPoint out;
  if (stretch(motion, last, first, time_s, out) || stretch(motion, first, last, time_s, out))
    return out;
  return rest_at(motion, last);  // rounding left a sliver of time at the end of the period
}

/// Circles about the axis through `centre`, from the last way point. The angular speed rises by 3
/// s^2 - 2 s^3 over the first 90 degrees, in the time of 180 degrees, so velocity and acceleration
/// have no step.
MotionPoint circle(const Motion& motion, const Vec3& centre, double time_s) noexcept {
  const Vec3& start = motion.path.back();
  const Vec3& axis = motion.circle_axis;
  const Vec3 offset = start - centre;
  const Vec3 radius = offset - axis * axis.dot(offset);
  const double length = radius.norm();
  if (!(length > 0.0))
    return {start, Vec3::Zero()};
  const double full_speed = motion.speed_m_per_s / length;  // [rad/s]
  const double rise_s = std::numbers::pi / full_speed;
  double angle = 0.0, speed = full_speed;
  if (time_s < rise_s) {
    const double s = time_s / rise_s;
    angle = std::numbers::pi * s * s * s * (1.0 - 0.5 * s);
    speed = full_speed * s * s * (3.0 - 2.0 * s);
  } else {
    angle = 0.5 * std::numbers::pi + full_speed * std::fmod(time_s - rise_s, 2.0 * rise_s);
  }
  const Vec3 across = axis.cross(radius);
  const Vec3 arm = radius * std::cos(angle) + across * std::sin(angle);
  return {start + (arm - radius), speed * axis.cross(arm)};
}

}  // namespace

std::uint32_t buttons_at(const Motion& motion, double time_s) noexcept {
  std::uint32_t down = 0;
  for (const ButtonPress& press : motion.press)
    if (time_s >= press.from_s && time_s < press.to_s)
      down |= 1U << (press.button & 31U);
  return down;
}

MotionOrientation orientation_at(const Motion& motion, double time_s) noexcept {
  const MotionRotation& turn = motion.turn;
  const double time = usable_time(time_s), duration = turn.to_s - turn.from_s;
  if (turn.angle_rad == 0.0 || time <= turn.from_s || !(duration > 0.0))
    return {motion.orientation, Vec3::Zero()};
  const auto [fraction, rate] =
      time < turn.to_s ? minimum_jerk(time - turn.from_s, duration) : Profile{1.0, 0.0};
  return {Quat(Eigen::AngleAxisd(fraction * turn.angle_rad, turn.axis)) * motion.orientation,
          rate * turn.angle_rad * turn.axis};
}

double approach_duration(const Motion& motion) noexcept {
  if (motion.path.empty() || !(motion.speed_m_per_s > 0.0))
    return 0.0;
  return motion.hold_s + stretch_duration(motion, 0, motion.path.size() - 1);
}

MotionPoint motion_at(const Motion& motion, double time_s) noexcept {
  if (motion.path.empty())
    return {};
  double left = usable_time(time_s);
  if (!(motion.speed_m_per_s > 0.0) || left < motion.hold_s)
    return rest_at(motion, 0);
  left -= motion.hold_s;
  const std::size_t last = motion.path.size() - 1;
  MotionPoint out;
  if (stretch(motion, 0, last, left, out))
    return out;
  if (motion.circle_centre)
    return circle(motion, *motion.circle_centre, left);
  if (motion.repeat_from && *motion.repeat_from < last)
    return back_and_forth(motion, *motion.repeat_from, left);
  return rest_at(motion, last);
}

Motion motion_in_device(const Motion& motion_W, const Pose& pose_WD, const Pose& pose_PT,
                        double position_scale) {
  const Quat rotation_DW = pose_WD.orientation.conjugate();
  Motion out = motion_W;
  out.orientation =
      (rotation_DW * motion_W.orientation * pose_PT.orientation.conjugate()).normalized();
  const Vec3 arm_PT_D =
      out.orientation * pose_PT.position;  // tip to tool's origin; not scaled: a length of W
  const auto point = [&](const Vec3& x) -> Vec3 {
    return (rotation_DW * (x - pose_WD.position) - arm_PT_D) / position_scale;
  };
  for (Vec3& x : out.path)
    x = point(x);
  if (motion_W.circle_centre)
    out.circle_centre = point(*motion_W.circle_centre);
  out.circle_axis = rotation_DW * motion_W.circle_axis;
  out.turn.axis = rotation_DW * motion_W.turn.axis;
  out.speed_m_per_s = motion_W.speed_m_per_s / position_scale;
  return out;
}

}  // namespace voxtouch
