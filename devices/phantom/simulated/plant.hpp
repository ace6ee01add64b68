#pragma once
/// Mechanics of a simulated, gripped Phantom: rigid links, joint friction, end stops, rotors.
#include "devices/operator/hand.hpp"
#include "devices/phantom/phantom_arm.hpp"

namespace voxtouch::hd_sim {

/// Of the integration; divisible by every servo rate of the device.
inline constexpr double kSubstepHz = 8000.0;
inline constexpr double kSubstep = 1.0 / kSubstepHz;

/// Values without a source are assumed.
struct PlantConfig {
  phantom::PhantomGeometry geometry;
  phantom::PhantomInertia inertia;
  double gravity_m_per_s2 = 9.81;
  double viscous_nms_per_rad = 5e-4;  ///< per joint; from a published replica
  double coulomb_nm = 0.01;           ///< per joint; 0.05 N at the tip
  /// At the joints: 8.5 N along each axis in the reset pose. The motors of a replica (0.129 Nm,
  /// drives 13.3, 11.2, 11.2) give 1.72, 1.44, 1.44.
  Vec3 motor_limit_nm{1.8275, 1.8275, 1.445};
  double turret_stop_rad = 1.5708;  ///< to both sides; from a replica
  double thigh_low_rad = -0.9, thigh_high_rad = 1.6;
  /// Limits of thigh minus shin, up and down: 65 and 55 degrees, from a replica.
  double fold_rad = 1.134, stretch_rad = 0.960;
  /// A replica's model has 10 and 0.1, which lets an operator press the arm into the stretched
  /// pose.
  double stop_nm_per_rad = 300.0, stop_nms_per_rad = 0.3;
};

/// Fourth-order Runge-Kutta at a fixed step: the undamped arm keeps its energy to 1e-9 in 10 s. Dry
/// friction is projected: it stops a joint but never drives it, and a resting joint loaded below
/// its friction stays exactly at rest. Real-time safe except construction, `set_hand` and `follow`.
/// Equal calls give bit-identical results.
class PhantomPlant {
 public:
  /// Starts at rest, with the tip at the start of the motion. Throws std::runtime_error for a start
  /// out of reach, and for a hand too stiff or too light for this step.
  PhantomPlant(const PlantConfig& config, const sim::OperatorConfig& hand, const Motion& motion,
               std::uint64_t seed, double hand_bandwidth_hz);

  /// Makes one substep under these motor torques [Nm], each limited.
  void step(const Vec3& motor_torque) noexcept;

  /// Changes the grip from now on. Throws as the constructor; the previous grip then stays.
  void set_hand(const sim::OperatorConfig& hand);
  /// Starts another motion. Throws as the constructor.
  void follow(const Motion& motion) { hand_.follow(motion); }

  const Vec3& joints() const noexcept { return joints_; }  ///< [rad], PhantomGeometry's
  const Vec3& rates() const noexcept { return rates_; }    ///< [rad/s]
  /// Position of the tip in D [m], and its velocity [m/s].
  Vec3 tip() const noexcept { return phantom::phantom_tip(config_.geometry, joints_); }
  Vec3 tip_velocity() const noexcept {
    return phantom::phantom_jacobian(config_.geometry, joints_) * rates_;
  }
  /// Over the last substep, after the limits [Nm].
  const Vec3& motor_torque() const noexcept { return motor_torque_; }
  /// At the start of the last substep, without the mass of the hand [N].
  const Vec3& hand_force() const noexcept { return hand_force_; }
  /// Force of the last torques at the tip [N]; zero if the arm is stretched.
  Vec3 motor_force() const noexcept;
  /// Of the arm only [J].
  double energy() const noexcept { return dynamics_.energy(joints_, rates_); }
  const hand::Hand& hand() const noexcept { return hand_; }
  const phantom::PhantomDynamics& dynamics() const noexcept { return dynamics_; }
  const PlantConfig& config() const noexcept { return config_; }

  /// Sets the state of the arm [rad, rad/s].
  void set_state(const Vec3& joints, const Vec3& rates) noexcept {
    joints_ = joints, rates_ = rates;
  }

 private:
  struct Locks {
    bool joint[3] = {false, false, false};
    bool all() const noexcept { return joint[0] && joint[1] && joint[2]; }
  };
  struct Load {
    hand::HandAction hand;
    Vec3 torque = Vec3::Zero();  // motors and dry friction
    Locks locks;
  };
  Vec3 acceleration(const Vec3& joints, const Vec3& rates, const Load& load,
                    Mat3* mobility = nullptr) const noexcept;
  Vec3 stop_torque(const Vec3& joints, const Vec3& rates) const noexcept;
  Locks resist(Load& load) const noexcept;  // adds friction to the load; returns the joints that
                                            // come to rest

  PlantConfig config_;
  phantom::PhantomDynamics dynamics_;
  hand::Hand hand_;
  Vec3 joints_, rates_ = Vec3::Zero(), motor_torque_ = Vec3::Zero(), hand_force_ = Vec3::Zero();
};

}  // namespace voxtouch::hd_sim
