#pragma once
/// The mechanics of a simulated device with an operator, without quantisation.
#include <optional>

#include "core/types/motion.hpp"
#include "devices/operator/target_follower.hpp"
#include "devices/sim/parameters.hpp"

namespace voxtouch::sim {

/// Three axes of a mass with viscous damping and dry friction, connected by spring and damper to a
/// target.
struct Mobility {
  Vec3 mass = Vec3::Ones();     ///< [kg] or [kg m^2], hand included
  double damping = 0.0;         ///< against the ground [Ns/m] or [Nms/rad]
  double friction = 0.0;        ///< Coulomb, one limit for the vector [N] or [Nm]
  double hand_damping = 0.0;    ///< against the target
  double hand_stiffness = 0.0;  ///< towards the target
};

/// One step of `dt_s` by the implicit midpoint rule: stable for any step, and an undamped spring
/// keeps its energy. No library function is called. `pull`: from the body to the target's position
/// in the middle of the step. `target_velocity`: in the middle of the step. Updates `velocity` and
/// returns the mean velocity over the step.
///
/// Friction takes at most what brings the end velocity to zero, so it never drives: a body at rest
/// below the friction limit stays exactly in place. A body that stops within the step does not
/// travel on to where it would stop, and one that reverses passes through rest; both only dissipate
/// energy.
Vec3 step_mobility(const Mobility& mobility, const Vec3& pull, const Vec3& target_velocity,
                   const Vec3& force, double dt_s, Vec3& velocity) noexcept;

/// Position, orientation and their rates, in D. Real-time safe after construction.
class SimPlant {
 public:
  /// At rest where `motion` starts. The parameters must be valid.
  SimPlant(const SimParameters& parameters, const OperatorConfig& hand, Motion motion);

  /// Makes the hand follow the targets of `lead` instead of its motion, from the motion's start on.
  /// `period_s`: time between two calls of `next_period`, from time 0 on.
  void be_led(double period_s, const DeviceDescription& device) noexcept;
  /// Sets the target of the tip in D; no effect before `be_led`.
  void lead(const Pose& target) noexcept {
    if (leader_)
      leader_->aim(target);
  }
  /// Ends a period of the device, which then gives `device_wrench`.
  void next_period(const Wrench& device_wrench) noexcept {
    if (leader_)
      leader_->advance(pose_, device_wrench);
  }

  /// Advances by one substep with the wrench `device_wrench` of the device and the force `tremor`
  /// of the hand.
  void step(const Wrench& device_wrench, const Vec3& tremor, double time_s, double dt_s) noexcept;

  const Pose& pose() const noexcept { return pose_; }
  const Twist& twist() const noexcept { return twist_; }
  bool held_at(double time_s) const noexcept {
    return !hand_.released && time_s < hand_.release_time_s;
  }
  /// Buttons pressed by the hand; none after the release.
  std::uint32_t buttons_at(double time_s) const noexcept {
    return held_at(time_s) ? voxtouch::buttons_at(motion_, time_s) : 0U;
  }
  /// Of the masses and the hand's springs about the target at `time_s` [J].
  double energy(double time_s) const noexcept;

  /// Sets pose and velocity of the tip in D [m/s, rad/s].
  void set_state(const Pose& pose, const Twist& twist) noexcept { pose_ = pose, twist_ = twist; }

 private:
  MotionPoint target_at(double time_s) const noexcept;
  MotionOrientation target_orientation_at(double time_s) const noexcept;
  /// From the tool's orientation to the target's: 2 sin(angle / 2) along the axis, in D. It is the
  /// torque of a spring with the energy 4 k (1 - cos(angle / 2)), and within 0.2 % of the angle up
  /// to 12 degrees.
  Vec3 rotation_to(const Quat& target) const noexcept;
  /// Force with which a hand that carries the tool compensates the device's drag at the target's
  /// velocity [N].
  Vec3 carrying_force(const Vec3& target_velocity) const noexcept;
  /// `held` with the grip that the hand has at `time_s`.
  Mobility gripped(Mobility held, double time_s) const noexcept;

  OperatorConfig hand_;
  Motion motion_;
  std::optional<hand::TargetFollower> leader_;
  Mobility free_translation_, free_rotation_, held_translation_, held_rotation_;
  Pose pose_;
  Twist twist_;
};

}  // namespace voxtouch::sim
