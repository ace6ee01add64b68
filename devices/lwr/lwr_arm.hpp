#pragma once
/// Geometry and limits of the light-weight robot 4 / 4+: seven revolute joints, in the order of the
/// wire (A1 A2 E1 A3 A4 A5 A6).
#include <array>

#include "devices/arm/arm_description.hpp"
#include "devices/arm/joints.hpp"

namespace voxtouch::lwr {

using LwrJoints = arm::Joints;
using LwrJacobian = arm::Jacobian;
using arm::joint_torque;

/// Per joint. If published models of the 4 and the 4+ differ, the smaller limit is used.
struct LwrLimits {
  LwrJoints position_rad;  ///< +-
  LwrJoints velocity_rad_s;
  LwrJoints torque_nm;
};
/// Limits of each joint in rad, rad/s and Nm.
LwrLimits lwr_limits() noexcept;

/// Forward kinematics. q = 0 is the arm stretched upwards; base frame: z up, along axis 1. Source:
/// standard Denavit-Hartenberg rows (theta = q_i, d, a = 0, alpha) that agree in two published
/// robot descriptions.
class LwrArm {
 public:
  static constexpr int kJoints = 7;
  /// [m]
  static constexpr std::array<double, kJoints> kD = {0.3105, 0.0, 0.400, 0.0, 0.390, 0.0, 0.078};
  static constexpr std::array<int, kJoints> kAlphaQuarterTurns = {1, -1, -1, 1, 1, -1, 0};

  /// `pose_FT`: the frame T, for poses, twists and wrenches.
  explicit LwrArm(const Pose& pose_FT = {}) noexcept : pose_FT_(pose_FT) {}

  /// All results for one posture, computed once.
  struct State {
    std::array<Pose, kJoints + 1> links;  ///< DH frame i in the base; 0 the base, 7 the flange
    Pose pose_BT;                         ///< T in the base B
    LwrJacobian jacobian;                 ///< geometric, about the tool's origin
  };
  /// Non-finite input gives non-finite output. Real-time safe.
  State at(const LwrJoints& q) const noexcept;
  /// Flange in the base, T in the base, and the Jacobian separately. Each costs as much as `at`.
  /// Real-time safe.
  Pose flange(const LwrJoints& q) const noexcept { return at(q).links.back(); }
  Pose tool(const LwrJoints& q) const noexcept { return at(q).pose_BT; }
  LwrJacobian jacobian(const LwrJoints& q) const noexcept { return at(q).jacobian; }
  const Pose& pose_FT() const noexcept { return pose_FT_; }

 private:
  Pose pose_FT_;
};

/// The same geometry and limits, for visualisation.
const arm::ArmDescription& lwr_description();

/// Elbow bent, hand in front: q = (0, 30, 0, -90, 0, 60, 0) degrees, far from every limit and
/// singularity.
LwrJoints lwr_rest_posture() noexcept;

}  // namespace voxtouch::lwr
