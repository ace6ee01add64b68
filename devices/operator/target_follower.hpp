#pragma once
/// A hand that is led by targets from outside, as those of a mouse: targets in, a smooth motion
/// out.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/types/motion.hpp"

namespace voxtouch::hand {

/// Follows a target by a sum of minimum-jerk steps (Flash and Hogan 1985), each of duration kStepS.
/// Eight steps begin within kStepS, each from the goal of the previous one towards the newest
/// target. Position, velocity and acceleration are continuous for any targets. The bandwidth is 7
/// Hz (-3 dB), below the 10 Hz of voluntary motion.
///
/// The goal stays within the limits of core/types/lead_limit.hpp for any target, also at rest: a
/// hand that presses harder yields.
///
/// Time is counted in calls of `advance`, not by a clock, so equal calls give bit-identical
/// results. All in the frame of the given poses. Real-time safe.
class TargetFollower {
 public:
  static constexpr std::size_t kSteps = 8;
  static constexpr double kStepS = 0.1;
  /// Without a target for so long no further step begins: the hand rests kStepS later.
  static constexpr double kRestS = 0.3;
  /// The goal moves no faster, however far the target is.
  static constexpr double kMaxSpeedMPerS = 0.5, kMaxRateRadPerS = 3.0;

  /// The device's largest force and torque and the stiffness of the hand. Infinity or 0: no limit.
  struct Strength {
    double force_n = std::numeric_limits<double>::infinity();
    double torque_nm = std::numeric_limits<double>::infinity();
    double stiffness_n_per_m = 0.0, stiffness_nm_per_rad = 0.0;
  };

  /// At rest at `start`. `period_s`: between two calls of `advance`; at most kStepS / kSteps.
  TargetFollower(const Pose& start, double period_s, const Strength& strength) noexcept;

  /// Sets the newest target. A non-finite one, or one with an invalid orientation, is ignored.
  void aim(const Pose& target) noexcept;
  /// One period passes; at its end the tip is at `tip` and the device gives `device_wrench`.
  void advance(const Pose& tip, const Wrench& device_wrench) noexcept;

  /// Position and velocity at `time_s` since the start, within the period that `advance` has begun.
  MotionPoint position_at(double time_s) const noexcept;
  /// Orientation and angular velocity.
  MotionOrientation orientation_at(double time_s) const noexcept;

 private:
  struct Step {
    Vec3 displacement = Vec3::Zero();
    Quat rotation = Quat::Identity();  ///< its scalar part is not below 0
    double start_s = 0.0;
  };
  Step begin_step(const Pose& tip, const Wrench& device_wrench) const noexcept;
  /// `requested` within the limits of the hand.
  Pose within_reach(const Pose& requested, const Pose& tip,
                    const Wrench& device_wrench) const noexcept;
  /// Calls `use(step, fraction, rate)` for each step, the oldest first: the completed fraction and
  /// its derivative [1/s].
  template <class Use>
  void for_each_step(double time_s, Use&& use) const noexcept;

  Strength strength_;
  double period_s_, step_s_;
  std::uint64_t interval_, rest_periods_;  ///< in periods
  std::uint64_t periods_ = 0, since_target_;
  std::array<Step, kSteps> steps_{};
  std::size_t oldest_ = 0;
  Pose base_, goal_;  ///< without any of the steps; with all of them done
  Pose target_;
};

}  // namespace voxtouch::hand
