#pragma once
/// Geometry and limits of the Franka Research 3 and the Panda: seven revolute joints with the same
/// geometry.
#include <array>

#include "devices/arm/arm_description.hpp"
#include "devices/arm/joints.hpp"

namespace voxtouch::fr3 {

using arm::Jacobian;
using arm::Joints;

/// For both arms. If published descriptions differ, the wider limit is used: they define possible,
/// not recommended values.
struct Fr3Limits {
  Joints lowest_rad, highest_rad;
  Joints velocity_rad_s;
  Joints torque_nm;
};
Fr3Limits fr3_limits() noexcept;

/// Forward kinematics. Base frame: z up, along axis 1. Source: the modified Denavit-Hartenberg rows
/// published by the manufacturer (a, d, alpha of the previous joint, then theta = q_i).
class Fr3Arm {
 public:
  static constexpr int kJoints = 7;
  static constexpr std::array<double, kJoints> kA = {0.0,     0.0, 0.0,  0.0825,
                                                     -0.0825, 0.0, 0.088};  ///< m
  /// [m]
  static constexpr std::array<double, kJoints> kD = {0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.0};
  static constexpr std::array<int, kJoints> kAlphaQuarterTurns = {0, -1, 1, 1, -1, 1, 1};
  static constexpr double kFlange = 0.107;  ///< m, along the last axis

  /// `pose_FT`: the frame T in the flange, for poses, twists and wrenches.
  explicit Fr3Arm(const Pose& pose_FT = {}) noexcept : pose_FT_(pose_FT) {}

  /// All results for one posture, computed once.
  struct State {
    Pose flange;        ///< in the base B
    Pose pose_BT;       ///< T in the base
    Jacobian jacobian;  ///< geometric, about the tool's origin
  };
  /// Non-finite input gives non-finite output. Real-time safe.
  State at(const Joints& q) const noexcept;

 private:
  Pose pose_FT_;
};

/// The same geometry and limits, for visualisation.
const arm::ArmDescription& fr3_description();

/// The start posture of the manufacturer's examples, q = (0, -45, 0, -135, 0, 90, 45) degrees:
/// elbow up, hand down in front, far from every limit and singularity.
Joints fr3_rest_posture() noexcept;

}  // namespace voxtouch::fr3
