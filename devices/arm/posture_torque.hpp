#pragma once
/// What keeps the elbow where it belongs while a hand leads the tool: seven joints, six degrees of
/// freedom at the tool, one left.
#include "devices/arm/joints.hpp"

namespace voxtouch::arm {

struct PostureRules {
  Joints posture = Joints::Zero();    ///< rad; where the free motion is drawn to
  double stiffness_nm_per_rad = 6.0;  ///< along the free motion
  double damping_nms_per_rad = 1.5;
  double max_torque_nm = 3.0;        ///< length of the torque vector over the seven joints
  double min_manipulability = 0.02;  ///< below it the torque fades to zero, linearly
  double ramp_s = 0.5;               ///< from nothing to full after force comes on
};

/// The one direction of joint motion that leaves the tool where it is, times sqrt(det(J J^T))
/// (Yoshikawa's manipulability, m^3): component i is (-1)^i times the determinant of J without
/// column i (Cauchy-Binet gives the length). Zero at a singularity.
Joints free_motion(const Jacobian& jacobian) noexcept;

/// -k n n^T (q - posture) - d n n^T rate, n the unit free motion: the projection onto null(J), cut
/// to `max_torque_nm`.
///
/// A torque in null(J) is at right angles to every J^T F, so a hand that holds the tool still feels
/// none of it; while the elbow swings the hand feels the reaction to its acceleration (no mass
/// matrix is used), which the small limit keeps to a few newtons. Non-finite in, zero out.
/// Real-time safe.
Joints posture_torque(const PostureRules& rules, const Jacobian& jacobian, const Joints& q,
                      const Joints& rate) noexcept;

}  // namespace voxtouch::arm
