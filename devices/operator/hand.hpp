#pragma once
/// The operator as a load at the tip of a simulated arm: a force towards the hand's target, and a
/// mass that moves with the tip. The emulators of real devices share it.
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types/motion.hpp"
#include "devices/sim/operator.hpp"
#include "devices/sim/tremor.hpp"

namespace voxtouch::hand {

/// A named grip: mass, damping and stiffness from published ranges of fingertips, pens and arms;
/// empty for an unknown name. "fingertip"; "pen", "pen-light", "pen-firm"; "arm", "arm-light",
/// "arm-firm", "arm-measured"; "released".
std::optional<sim::OperatorConfig> grip(std::string_view name);
/// Those names, in that order.
const std::vector<std::string_view>& grip_names();

/// The grip itself. Throws as OperatorConfig::validate does.
const sim::OperatorConfig& checked_grip(const sim::OperatorConfig& grip);
/// The motion with normalised orientations. Throws std::runtime_error for an invalid motion: no way
/// point, NaN or infinity, no speed, an invalid orientation.
Motion checked_motion(Motion motion);

/// Drag of the tool that a hand compensates; see OperatorConfig::carries_tool.
struct ToolDrag {
  double damping_ns_per_m = 0.0;
  double coulomb_friction_n = 0.0;
};

/// The hand over one step: constants of its springs, and their targets in the middle of the step.
/// All zero: released.
struct HandAction {
  double mass_kg = 0.0, damping_ns_per_m = 0.0, stiffness_n_per_m = 0.0;
  double inertia_kg_m2 = 0.0, damping_nms_per_rad = 0.0, stiffness_nm_per_rad = 0.0;
  MotionPoint target;                          ///< of the tip, in D
  Quat target_orientation = Quat::Identity();  ///< of the tool in D
  Vec3 steady_force = Vec3::Zero();  ///< [N] tremor and carrying: the same all over the step

  /// On the tip [N]. The mass is not in it: it belongs into the arm's mass matrix as J^T m J.
  Vec3 force(const Vec3& position, const Vec3& velocity) const noexcept {
    return stiffness_n_per_m * (target.position - position) +
           damping_ns_per_m * (target.velocity - velocity) + steady_force;
  }
  /// Torque on the tool in D [Nm]. 2 sin(angle / 2) approximates the angle, within 0.2 % up to 12
  /// degrees.
  Vec3 torque(const Quat& orientation, const Vec3& angular_velocity) const noexcept {
    const Quat rotation = target_orientation * orientation.conjugate();
    return (rotation.w() < 0.0 ? -2.0 : 2.0) * stiffness_nm_per_rad * rotation.vec() -
           damping_nms_per_rad * angular_velocity;
  }
};

/// Follows a Motion through first-order lags, two for the position and one for the orientation,
/// which limit it to the bandwidth of voluntary movement. Equal calls give bit-identical results.
/// Real-time safe except for the constructor, `follow` and `grip_as`.
class Hand {
 public:
  /// Voluntary movement reaches 2 to 5 Hz; -3 dB of both lags together.
  static constexpr double kBandwidthHz = 5.0;

  /// `motion`: of the tip in D. `step_s`: length of a step, (0, 0.01]. `seed`: of the tremor.
  /// `bandwidth_hz` > 0; infinity: the target is the motion itself. Throws std::runtime_error if an
  /// argument is invalid.
  Hand(const sim::OperatorConfig& config, Motion motion, double step_s, std::uint64_t seed = 0,
       const ToolDrag& drag = {}, double bandwidth_hz = kBandwidthHz);

  /// The hand over the next step; time moves on by `step_s`.
  HandAction step() noexcept;

  double time_s() const noexcept { return static_cast<double>(steps_) * step_s_; }
  bool holds() const noexcept { return !config_.released && time_s() < config_.release_time_s; }
  const sim::OperatorConfig& config() const noexcept { return config_; }
  const Vec3& target() const noexcept { return second_; }  ///< present target of the tip
  const Quat& orientation() const noexcept { return orientation_; }

  /// Changes the grip. Its times are on this hand's clock. Throws as the constructor does.
  void grip_as(const sim::OperatorConfig& config);
  /// Starts another motion; the target reaches it through the lags. Throws as the constructor does.
  void follow(Motion motion);

 private:
  MotionPoint lead(const MotionPoint& requested, const Quat& goal) noexcept;

  sim::OperatorConfig config_;
  Motion motion_;
  double step_s_,
      gain_ = 1.0,
      rate_ = 0.0;  // gain_: of one lag over one step; rate_: its corner [rad/s]; 0: no lags
  ToolDrag drag_;
  std::uint64_t seed_;
  sim::Tremor tremor_;
  std::uint64_t steps_ = 0;
  double motion_start_s_ = 0.0;
  Vec3 first_, second_;
  Quat orientation_;
};

}  // namespace voxtouch::hand
