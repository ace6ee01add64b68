#pragma once
/// Keeps the elbow in place while the operator moves the tool: of seven joints, six degrees of
/// freedom are those of the tool, and one remains.
#include "devices/arm/joints.hpp"

namespace voxtouch::arm {

struct PostureRules {
  Joints posture = Joints::Zero();    ///< rad; goal of the null-space motion
  double stiffness_nm_per_rad = 6.0;  ///< along the null-space motion
  double damping_nms_per_rad = 1.5;
  double max_torque_nm = 3.0;        ///< length of the torque vector over the seven joints
  double min_manipulability = 0.02;  ///< [m^3] below it the torque falls to zero, linearly
  double ramp_s = 0.5;               ///< fade-in time after force is enabled
};

/// The direction of joint motion that leaves the tool in place, times sqrt(det(J J^T)) (Yoshikawa's
/// manipulability, m^3). Component i is (-1)^i times the determinant of J without column i
/// (Cauchy-Binet gives the length). Zero at a singularity.
Joints free_motion(const Jacobian& jacobian) noexcept;

/// Torque along the unit null-space direction n; w is the manipulability:
///
///     min(1, w / min_manipulability) clamp(n^T (k (posture - q) - d rate), max_torque_nm) n
///
/// A torque in null(J) is orthogonal to every J^T F, so the operator of a resting tool receives no
/// force from it. While the elbow moves, the operator receives the reaction to its acceleration (no
/// mass matrix is used), which the small limit keeps to a few newtons. Non-finite input gives zero.
/// Real-time safe.
Joints posture_torque(const PostureRules& rules, const Jacobian& jacobian, const Joints& q,
                      const Joints& rate) noexcept;

}  // namespace voxtouch::arm
