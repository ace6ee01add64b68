#pragma once
/// Mechanics of the arm: state, time integration, dry friction, brakes, stops, and a hand at the
/// tool.
#include <limits>

#include "devices/arm/simulated/arm_dynamics.hpp"
#include "devices/operator/hand.hpp"

namespace voxtouch::arm_sim {

/// Properties of the drives under torque control, and the joint limits.
struct PlantParameters {
  ArmBodies bodies;
  Pose pose_FT;
  arm::Joints viscous_nms_per_rad = arm::Joints::Zero();
  arm::Joints coulomb_nm = arm::Joints::Zero();
  arm::Joints brake_nm = arm::Joints::Zero();  ///< largest holding torque of a closed brake
  /// Of the drives, gravity included.
  arm::Joints torque_limit_nm = arm::Joints::Constant(std::numeric_limits<double>::infinity());
  /// Positions of inelastic stops.
  arm::Joints highest_rad = arm::Joints::Constant(std::numeric_limits<double>::infinity());
  arm::Joints lowest_rad = -highest_rad;
};

enum class Drives {
  kTorque,  ///< the commanded torque plus gravity
  kBraked,  ///< no torque, brakes closed
};

class ArmPlant {
 public:
  /// Starts at rest at `q`.
  ArmPlant(const PlantParameters& parameters, const arm::Joints& q);

  /// Advances by `dt_s` with constant `torque`, in addition to gravity, which the drives compensate
  /// exactly; the sum is limited to the drives. `hand`: over this step, in the base. Smooth forces
  /// use the classical fourth-order Runge-Kutta method. Dry friction, brakes and stops follow as
  /// impulses that only reduce speed: a joint loaded below its friction stays exactly in place.
  /// Real-time safe.
  void step(const arm::Joints& torque, Drives drives, const hand::HandAction& hand,
            double dt_s) noexcept;

  const arm::Joints& q() const noexcept { return q_; }
  const arm::Joints& rate() const noexcept { return rate_; }
  void set_state(const arm::Joints& q, const arm::Joints& rate) noexcept { q_ = q, rate_ = rate; }
  /// Torques measured between drives and links in the last step: drives, friction and brakes [Nm].
  const arm::Joints& sensed_torque() const noexcept { return sensed_; }
  /// Wrench of the hand on the tool at the start of the last step.
  const Wrench& hand_wrench() const noexcept { return hand_wrench_; }
  /// Whether a stop held a joint in the last step.
  bool at_stop() const noexcept { return at_stop_; }
  ArmDynamics::Terms terms(const TipLoad& load = {}) const noexcept {
    return dynamics_.at(q_, rate_, load);
  }
  const ArmDynamics& dynamics() const noexcept { return dynamics_; }

 private:
  struct Slope {
    arm::Joints rate, acceleration;
  };
  struct Step {
    const arm::Joints& torque;
    Drives drives;
    const hand::HandAction& hand;
  };
  Slope slope(const Step& step, const arm::Joints& q, const arm::Joints& rate,
              ArmDynamics::Terms& terms) const noexcept;
  arm::Joints drive_torque(const Step& step, const arm::Joints& gravity) const noexcept;
  /// Friction, brakes and stops: the impulse at each joint, within its bounds, that minimises the
  /// speed at the end of the step.
  arm::Joints sticking_impulse(const JointMatrix& mass, const arm::Joints& q,
                               const arm::Joints& rate, Drives drives, double dt_s) noexcept;

  PlantParameters parameters_;
  ArmDynamics dynamics_;
  arm::Joints q_, rate_ = arm::Joints::Zero(), sensed_ = arm::Joints::Zero();
  Wrench hand_wrench_;
  bool at_stop_ = false;
};

}  // namespace voxtouch::arm_sim
