#pragma once
/// Rigid-body dynamics of an arm with seven joints: M(q) q'' + c(q, q') + g(q) = torque. All
/// functions are real-time safe.
#include <array>
#include <cstdint>

#include "core/types/geometry.hpp"
#include "devices/arm/joints.hpp"

namespace voxtouch::arm_sim {

using JointMatrix = Eigen::Matrix<double, 7, 7>;

inline constexpr double kGravity = 9.81;  ///< [m/s^2], along -z of the base

/// One link in its own frame: at q = 0 all link frames are parallel to the base.
struct Link {
  double mass_kg = 0.0;
  Vec3 centre_m = Vec3::Zero();
  Vec3 inertia_kg_m2 = Vec3::Zero();  ///< principal, about the centre
  Mat3 axes = Mat3::Identity();       ///< of the principal inertia, in the link
};

/// Axis of a joint at q = 0, in the base.
enum class Axis : std::uint8_t { kZ, kMinusZ, kY, kMinusY };

struct JointPlace {
  /// From the previous joint (the base's origin) to this one, in the frame of the previous link.
  Vec3 from_last_m = Vec3::Zero();
  Axis axis = Axis::kZ;
};

struct ArmBodies {
  std::array<JointPlace, 7> joints{};
  std::array<Link, 7> links{};
  arm::Joints rotor_kg_m2 = arm::Joints::Zero();  ///< added to the diagonal of M
};

/// A load at the tool's origin that is not part of the arm: a hand. It supports its own weight, so
/// it adds to M and c, not to g.
struct TipLoad {
  double mass_kg = 0.0;
  double inertia_kg_m2 = 0.0;  ///< equal about any axis
};

class ArmDynamics {
 public:
  /// `bodies` must be physically consistent. `pose_FT`: the frame T in the last link; its origin
  /// carries the load.
  explicit ArmDynamics(const ArmBodies& bodies, const Pose& pose_FT = {}) noexcept
      : bodies_(bodies),
        pose_FT_(pose_FT) {}

  /// All results for one state.
  struct Terms {
    JointMatrix mass;        ///< M(q), rotors and load included [kg m^2]
    arm::Joints coriolis;    ///< c(q, q') [Nm]
    arm::Joints gravity;     ///< g(q): the torque that balances gravity [Nm]
    Pose tool;               ///< T in the base
    arm::Jacobian jacobian;  ///< of the tool's origin, base axes, linear first
    Twist twist;             ///< of the tool
  };
  /// At the joints `q` [rad], `rate` [rad/s], with `load` at the tip. Real-time safe.
  Terms at(const arm::Joints& q, const arm::Joints& rate, const TipLoad& load = {}) const noexcept;

  /// Pose of a link: a point p of the link is rotation * p + origin in the base.
  struct Frame {
    Mat3 rotation;
    Vec3 origin;  ///< on the joint's axis
    Vec3 axis;    ///< of the joint, in the base
  };
  /// Poses of the links at the joints `q` [rad].
  std::array<Frame, 7> links(const arm::Joints& q) const noexcept;

  const ArmBodies& bodies() const noexcept { return bodies_; }
  const Pose& pose_FT() const noexcept { return pose_FT_; }

 private:
  ArmBodies bodies_;
  Pose pose_FT_;
};

}  // namespace voxtouch::arm_sim
