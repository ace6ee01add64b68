#pragma once
/// The arm as mechanics: state, integration in time, dry friction, brakes, stops, and a hand at the
/// tool.
#include <limits>

#include "devices/arm/simulated/arm_dynamics.hpp"
#include "devices/operator/hand.hpp"

namespace voxtouch::arm_sim {

/// What torque control leaves of the drives at the tool, and where the arm ends.
struct PlantParameters {
  ArmBodies bodies;
  Pose pose_FT;
  arm::Joints viscous_nms_per_rad = arm::Joints::Zero();
  arm::Joints coulomb_nm = arm::Joints::Zero();
  arm::Joints brake_nm = arm::Joints::Zero();  ///< most that a closed brake holds
  arm::Joints torque_limit_nm = arm::Joints::Constant(
      std::numeric_limits<double>::infinity());  ///< of the drives, gravity included
  arm::Joints highest_rad = arm::Joints::Constant(
      std::numeric_limits<double>::infinity());  ///< a stop that takes all speed
  arm::Joints lowest_rad = -highest_rad;         ///< likewise
};

enum class Drives {
  kTorque,  ///< what is commanded, and gravity in addition
  kBraked,  ///< no torque, brakes closed
};

class ArmPlant {
 public:
  /// At rest at `q`.
  ArmPlant(const PlantParameters& parameters, const arm::Joints& q);

  /// Moves on by `dt_s` with `torque` held (beyond gravity, which the drives carry exactly; the sum
  /// is cut to the drives' limits). `hand`: over this step, in the base. Classical Runge-Kutta of
  /// fourth order for all smooth forces; then dry friction, brakes and stops as impulses that take
  /// speed and never give any: a joint under less than its friction stays exactly where it is.
  /// Real-time safe.
  void step(const arm::Joints& torque, Drives drives, const hand::HandAction& hand,
            double dt_s) noexcept;

  const arm::Joints& q() const noexcept { return q_; }
  const arm::Joints& rate() const noexcept { return rate_; }
  void set_state(const arm::Joints& q, const arm::Joints& rate) noexcept { q_ = q, rate_ = rate; }
  /// What sensors between drives and links measured in the last step: drives, friction and brakes
  /// [Nm].
  const arm::Joints& sensed_torque() const noexcept { return sensed_; }
  /// On the tool in the last step: the hand at its start.
  const Wrench& hand_wrench() const noexcept { return hand_wrench_; }
  /// A stop held a joint in the last step.
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
  /// Friction, brakes and stops: the impulse at each joint, within its bounds, that brings the
  /// step's end nearest to rest.
  arm::Joints sticking_impulse(const JointMatrix& mass, const arm::Joints& q,
                               const arm::Joints& rate, Drives drives, double dt_s) noexcept;

  PlantParameters parameters_;
  ArmDynamics dynamics_;
  arm::Joints q_, rate_ = arm::Joints::Zero(), sensed_ = arm::Joints::Zero();
  Wrench hand_wrench_;
  bool at_stop_ = false;
};

}  // namespace voxtouch::arm_sim
