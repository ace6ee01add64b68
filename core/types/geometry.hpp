#pragma once
/// Value types and frames, defined once for the whole project.
///
/// Frames:
///   W  world: scenes, voxmaps and contact wrenches.
///   D  device base: the pose and force of a device.
///   T  tool: the frame of the dynamic object's mesh; torques are about its origin.
///   P  tip: the point of the device that the hand moves; T is fixed to it.
///
/// A pose `T in W` maps points of T to W: x_W = orientation * x_T + position. Names with two frames
/// end in them: `pose_WT` is T in W, `rotation_DW` rotates axes of W to axes of D, `wrench_D` and
/// `arm_PT_W` (from P to T) have the axes of their last letter.
///
/// Units are SI: metres, seconds, newtons, newton metres, radians. A bare number in an interface
/// has its unit in its name (`stiffness_n_per_m`). Quaternions are unit, written w x y z.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace voxtouch {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;  ///< translation first, then rotation
using Mat6 = Eigen::Matrix<double, 6, 6>;  ///< translation first, then rotation
using Quat = Eigen::Quaterniond;

/// Position [m] and orientation (unit quaternion) of one frame in another.
struct Pose {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();

  /// The point `local` of the posed frame, in the outer frame [m].
  Vec3 operator*(const Vec3& local) const noexcept { return orientation * local + position; }
  /// Composition: (A in B) * (C in A) = C in B.
  Pose operator*(const Pose& inner) const noexcept {
    return {orientation * inner.position + position, orientation * inner.orientation};
  }
  Pose inverse() const noexcept {
    const Quat back = orientation.conjugate();
    return {-(back * position), back};
  }
  bool finite() const noexcept { return position.allFinite() && orientation.coeffs().allFinite(); }
  bool operator==(const Pose&) const = default;
};

/// Velocity of a frame's origin [m/s] and angular velocity [rad/s], both in the outer frame's axes.
struct Twist {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
  bool finite() const noexcept { return linear.allFinite() && angular.allFinite(); }
};

/// Force [N] and torque [Nm] about the tool's origin, in the outer frame's axes.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  bool finite() const noexcept { return force.allFinite() && torque.allFinite(); }
  bool zero() const noexcept { return force.isZero(0.0) && torque.isZero(0.0); }
};

/// The matrix of v x: cross_matrix(v) * x = v x x. Real-time safe.
inline Mat3 cross_matrix(const Vec3& v) noexcept {
  return (Mat3() << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0).finished();
}

/// Normalises `q` if its norm lies in [`low`, `high`]; false and `q` untouched otherwise (also for
/// NaN and Inf).
inline bool normalise_within(Quat& q, double low, double high) noexcept {
  const double norm = q.norm();
  if (!(norm >= low && norm <= high))
    return false;
  q.coeffs() /= norm;
  return true;
}

}  // namespace voxtouch
