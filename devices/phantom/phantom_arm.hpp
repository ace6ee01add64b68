#pragma once
/// Kinematics and dynamics of the Phantom's arm: a turret, a thigh and a shin, driven from the base
/// by a parallel linkage. Model and figures: M. C. Cavusoglu, D. Feygin, F. Tendick, "A critical
/// study of the mechanical and electrical properties of the PHANToM haptic interface", Presence 11
/// (2002).
///
/// Joints: 0 turret about +y (right-handed), 1 thigh from the horizontal (up +), 2 shin from the
/// vertical (up +). All are relative to the base, so the third does not include the second. Frame
/// D: +x right, +y up, +z to the operator. Its origin is the tip in the reset pose, where all
/// joints are zero, the thigh is horizontal and the shin vertical.
#include <array>
#include <optional>

#include "core/types/geometry.hpp"
#include "devices/arm/arm_description.hpp"

namespace voxtouch::phantom {

struct PhantomGeometry {
  double thigh_m = 0.215;
  double shin_m = 0.170;
};

/// Links of the published model: a is the shin's bar with the tip, c the bar parallel to the thigh,
/// be and df the two bars with the motors, base the turret. Principal moments about the axes of
/// each bar.
struct PhantomInertia {
  double a_kg = 0.0202, c_kg = 0.0249, be_kg = 0.2359, df_kg = 0.1906;
  Vec3 a_kg_m2{0.4864e-4, 0.001843e-4, 0.4864e-4};
  Vec3 c_kg_m2{0.959e-4, 0.959e-4, 0.0051e-4};
  Vec3 be_kg_m2{11.09e-4, 10.06e-4, 0.591e-4};
  Vec3 df_kg_m2{7.11e-4, 0.629e-4, 6.246e-4};
  double base_yy_kg_m2 = 11.87e-4;
  double l3_m = 0.0325, l5_m = -0.0368, l6_m = 0.0527;  ///< offsets of bars and counterweights
  Vec3 rotor_kg_m2{1.9e-4, 1.35e-4, 1.35e-4};           ///< of the motors, reflected to the joints
};

/// The tip in D [m].
Vec3 phantom_tip(const PhantomGeometry& geometry, const Vec3& joints) noexcept;
/// d tip / d joints [m/rad]; its transpose times a force at the tip is the joint torque.
Mat3 phantom_jacobian(const PhantomGeometry& geometry, const Vec3& joints) noexcept;
/// Its time derivative.
Mat3 phantom_jacobian_rate(const PhantomGeometry& geometry, const Vec3& joints,
                           const Vec3& rates) noexcept;
/// Inverse kinematics of the tip, with the elbow up. Absent if the arm does not reach (joint limits
/// are ignored) or the tip is on the turret's axis.
std::optional<Vec3> phantom_joints(const PhantomGeometry& geometry, const Vec3& tip) noexcept;

/// Orientation of the shin in D: identity in the reset pose.
Quat phantom_shin(const Vec3& joints) noexcept;

/// The gimbal angles of a stylus `orientation` in D: about the shin, up and down, about the stylus,
/// with the signs of the library (right +, up -, clockwise +). The middle one is in [-pi/2, pi/2].
Vec3 gimbal_angles(const Vec3& joints, const Quat& orientation) noexcept;
/// The inverse: orientation of the stylus in D.
Quat stylus_orientation(const Vec3& joints, const Vec3& gimbal) noexcept;

/// The arm as a chain for visualisation: turret, thigh, elbow (shin relative to thigh), and the
/// three gimbal joints with the signs of the library. The base is D as defined by the library.
/// Geometry of a Premium 1.5; limits are assumed.
inline constexpr int kChainJoints = 6;
const arm::ArmDescription& phantom_description();
/// Angles of that chain for a tip and a stylus in D [rad]; absent if the arm does not reach.
/// Real-time safe.
std::optional<std::array<double, kChainJoints>> phantom_chain(const PhantomGeometry& geometry,
                                                              const Vec3& tip,
                                                              const Quat& orientation) noexcept;

/// The arm without load: M(q) q'' + C(q, q') q' + G(q) = torque. M includes the rotors. Constants
/// are computed once; all calls are real-time safe.
class PhantomDynamics {
 public:
  explicit PhantomDynamics(const PhantomGeometry& geometry = {}, const PhantomInertia& inertia = {},
                           double gravity_m_per_s2 = 9.81) noexcept;

  Mat3 mass(const Vec3& joints) const noexcept;  ///< [kg m^2]
  /// From the Christoffel symbols [Nms/rad].
  Mat3 coriolis(const Vec3& joints, const Vec3& rates) const noexcept;
  Vec3 gravity(const Vec3& joints) const noexcept;      ///< [Nm]
  double potential(const Vec3& joints) const noexcept;  ///< whose gradient is `gravity` [J]
  /// Kinetic and potential [J].
  double energy(const Vec3& joints, const Vec3& rates) const noexcept;
  const PhantomGeometry& geometry() const noexcept { return geometry_; }

 private:
  PhantomGeometry geometry_;
  // M11 = turret + thigh_wave cos 2t2 + shin_wave cos 2t3 + cross cos t2 sin t3.
  double turret_, thigh_wave_, shin_wave_, cross_;
  double thigh_, shin_;
  double thigh_weight_, shin_weight_;  // [Nm]
  Vec3 rotor_;
};

}  // namespace voxtouch::phantom
