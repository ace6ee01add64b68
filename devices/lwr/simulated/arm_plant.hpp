#pragma once
/// The arm as mechanics: state, integration in time, dry friction, brakes, stops, and somebody's hand at the tool.
#include <limits>

#include "devices/lwr/simulated/arm_dynamics.hpp"
#include "devices/operator/hand.hpp"

namespace voxtouch::lwr_sim {

/// What torque control leaves to be felt of the drives, and where the arm ends.
struct PlantParameters {
  ArmInertia inertia = lwr_inertia();
  Pose pose_FT;
  lwr::LwrJoints viscous_nms_per_rad = lwr::LwrJoints::Zero();
  lwr::LwrJoints coulomb_nm = lwr::LwrJoints::Zero();
  lwr::LwrJoints brake_nm = lwr::LwrJoints::Zero();  ///< most that a closed brake holds
  lwr::LwrJoints torque_limit_nm =
      lwr::LwrJoints::Constant(std::numeric_limits<double>::infinity());  ///< of the drives, gravity included
  lwr::LwrJoints position_limit_rad =
      lwr::LwrJoints::Constant(std::numeric_limits<double>::infinity());  ///< +-, a stop that takes all speed
};

/// Published drive friction, divided by the gain of the torque feedback, which hides it as it hides the rotors (assumed);
/// brakes of twice the drives' torque (assumed); published limits.
PlantParameters lwr_plant(double torque_feedback_gain = 4.0);

enum class Drives {
  kTorque,  ///< what is commanded, and gravity beside it
  kBraked,  ///< no torque, brakes closed
};

class ArmPlant {
 public:
  /// At rest at `q`.
  ArmPlant(const PlantParameters& parameters, const lwr::LwrJoints& q);

  /// Moves on by `dt_s` with `torque` held (beyond gravity, which the drives carry exactly; the sum is cut to the drives'
  /// limits). `hand`: over this step, in the base. Classical Runge-Kutta of fourth order for all smooth forces; then dry friction, brakes and stops as impulses that
  /// take speed and never give any: a joint under less than its friction stays exactly where it is. Real-time safe.
  void step(const lwr::LwrJoints& torque, Drives drives, const hand::HandAction& hand, double dt_s) noexcept;

  const lwr::LwrJoints& q() const noexcept { return q_; }
  const lwr::LwrJoints& rate() const noexcept { return rate_; }
  void set_state(const lwr::LwrJoints& q, const lwr::LwrJoints& rate) noexcept { q_ = q, rate_ = rate; }
  /// What sensors between drives and links felt in the last step: drives, friction and brakes [Nm].
  const lwr::LwrJoints& sensed_torque() const noexcept { return sensed_; }
  /// On the tool in the last step: the hand at its start.
  const Wrench& hand_wrench() const noexcept { return hand_wrench_; }
  /// A stop held a joint in the last step.
  bool at_stop() const noexcept { return at_stop_; }
  ArmDynamics::Terms terms(const TipLoad& load = {}) const noexcept { return dynamics_.at(q_, rate_, load); }
  const ArmDynamics& dynamics() const noexcept { return dynamics_; }

 private:
  struct Slope {
    lwr::LwrJoints rate, acceleration;
  };
  struct Step {
    const lwr::LwrJoints& torque;
    Drives drives;
    const hand::HandAction& hand;
  };
  Slope slope(const Step& step, const lwr::LwrJoints& q, const lwr::LwrJoints& rate, ArmDynamics::Terms& terms) const noexcept;
  lwr::LwrJoints drive_torque(const Step& step, const lwr::LwrJoints& gravity) const noexcept;
  /// Friction, brakes and stops: the impulse at each joint, within its bounds, that brings the step's end nearest to rest.
  lwr::LwrJoints sticking_impulse(const LwrMatrix& mass, const lwr::LwrJoints& q, const lwr::LwrJoints& rate, Drives drives,
                            double dt_s) noexcept;

  PlantParameters parameters_;
  ArmDynamics dynamics_;
  lwr::LwrJoints q_, rate_ = lwr::LwrJoints::Zero(), sensed_ = lwr::LwrJoints::Zero();
  Wrench hand_wrench_;
  bool at_stop_ = false;
};

}  // namespace voxtouch::lwr_sim
