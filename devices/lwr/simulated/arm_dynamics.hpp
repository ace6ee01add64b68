#pragma once
/// Rigid-body dynamics of the light-weight robot: M(q) q'' + c(q, q') + g(q) = torque. Arithmetic, real-time safe throughout.
#include <array>

#include "core/types/geometry.hpp"
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr_sim {

using LwrMatrix = Eigen::Matrix<double, 7, 7>;

inline constexpr double kGravity = 9.81;  ///< [m/s^2], along -z of the base

/// One link in its own frame: at q = 0 all link frames are parallel to the base, one above the other.
struct Link {
  double mass_kg = 0.0;
  Vec3 centre_m = Vec3::Zero();
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< principal, about the centre, along the link's axes
};

struct ArmInertia {
  std::array<Link, 7> links{};
  lwr::LwrJoints rotor_kg_m2 = lwr::LwrJoints::Zero();  ///< added to the diagonal of M
};

/// Links: the physically consistent set of published robot descriptions (confirmed). Rotors: reflected motor inertia
/// (unconfirmed), divided by `torque_feedback_gain`: a torque loop that feeds back k times the torque error makes the motor
/// appear (1 + k) times lighter; 4 is assumed.
ArmInertia lwr_inertia(double torque_feedback_gain = 4.0);

/// What moves with the tool's origin and is not the arm's: a hand. It carries its own weight, so it adds to M and c, not to g.
struct TipLoad {
  double mass_kg = 0.0;
  double inertia_kg_m2 = 0.0;  ///< the same about any axis
};

class ArmDynamics {
 public:
  /// `inertia`: of bodies that can be. `pose_FT`: the frame T, whose origin carries the load.
  explicit ArmDynamics(const ArmInertia& inertia = lwr_inertia(), const Pose& pose_FT = {}) noexcept
      : inertia_(inertia), pose_FT_(pose_FT) {}

  /// All that one state gives.
  struct Terms {
    LwrMatrix mass;        ///< M(q), rotors and load included [kg m^2]
    lwr::LwrJoints coriolis;    ///< c(q, q') [Nm]
    lwr::LwrJoints gravity;     ///< g(q): the torque that holds the arm still [Nm]
    Pose tool;             ///< T in the base
    lwr::LwrJacobian jacobian;  ///< of the tool's origin, base axes, linear first
    Twist twist;           ///< of the tool
  };
  Terms at(const lwr::LwrJoints& q, const lwr::LwrJoints& rate, const TipLoad& load = {}) const noexcept;

  /// Where a link is: a point of it in the base is rotation * point + origin.
  struct Frame {
    Mat3 rotation;
    Vec3 origin;  ///< on the joint's axis
    Vec3 axis;    ///< of the joint, in the base
  };
  std::array<Frame, 7> links(const lwr::LwrJoints& q) const noexcept;

  const ArmInertia& inertia() const noexcept { return inertia_; }
  const Pose& pose_FT() const noexcept { return pose_FT_; }

 private:
  ArmInertia inertia_;
  Pose pose_FT_;
};

}  // namespace voxtouch::lwr_sim
