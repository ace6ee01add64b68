#include "core/effects/rigid_body.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace voxtouch::effects {
namespace {

/// Rotation vector that turns `from` into `to`, the short way, W axes.
Vec3 turn_between(const Quat& from, const Quat& to) noexcept {
  Quat q = to * from.conjugate();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  return s < 1e-12 ? Vec3(2.0 * q.vec()) : Vec3((2.0 * std::atan2(s, q.w()) / s) * q.vec());
}

Vec6 stacked(const Vec3& a, const Vec3& b) noexcept { return (Vec6() << a, b).finished(); }

void cut(Vec3& v, double most) noexcept {
  if (const double n = v.norm(); n > most) v *= most / n;
}

}  // namespace

void RigidBody::place(const Pose& pose, bool held) noexcept {
  pose_WB_ = pose, twist_ = {}, pose_TB_ = {}, held_ = held, placed_ = true;
  strength_ = coupling::Ramp(held ? 1.0 : 0.0);
  energy_j_ = 0.0;
}

void RigidBody::follow_hold(const Pose& pose_WT, bool hold, double grab_m, double dt_s) noexcept {
  if (hold && !held_ && (pose_WT.position - pose_WB_.position).norm() <= grab_m) {
    held_ = true;
    pose_TB_ = pose_WT.inverse() * pose_WB_;
    strength_ = coupling::Ramp(0.0);  // it hangs as it lies: no force to begin with, whatever was left of the last grip
    strength_.head_for(1.0, kGripRampS);
  } else if (!hold && held_) {
    held_ = false;
    strength_.head_for(0.0, kGripRampS);
  }
  strength_.advance(dt_s);
}

BodyGrip RigidBody::step(const BodyLoad& load, const Pose& pose_WT, const Twist& tool_twist, bool hold, double grab_m,
                         const BodyParameters& p, double dt_s) noexcept {
  follow_hold(pose_WT, hold, grab_m, dt_s);
  const Mat3 turn = pose_WB_.orientation.toRotationMatrix();
  const Vec3 arm = turn * shape_.centre;  // from the origin to the centre of mass
  const Mat3 across = cross_matrix(arm), central = p.mass_kg * (turn * shape_.inertia_m2 * turn.transpose());
  Mat6 mass;
  mass.topLeftCorner<3, 3>() = p.mass_kg * Mat3::Identity();
  mass.topRightCorner<3, 3>() = -p.mass_kg * across;
  mass.bottomLeftCorner<3, 3>() = p.mass_kg * across;
  mass.bottomRightCorner<3, 3>() = central - p.mass_kg * across * across;

  // The grip: spring and damper to where the body hangs on the tool.
  const double strength = strength_.now(), ratio = 2.0 * p.grip_damping_ratio;
  const double c = strength * p.grip_n_per_m, c_turn = strength * p.grip_nm_per_rad;
  const double least_inertia = p.mass_kg * shape_.inertia_m2.diagonal().minCoeff();
  const double r = strength * ratio * std::sqrt(p.grip_n_per_m * p.mass_kg);
  const double r_turn = strength * ratio * std::sqrt(p.grip_nm_per_rad * least_inertia);
  const Pose goal_WB = pose_WT * pose_TB_;
  const Vec3 goal_velocity_W = tool_twist.linear + tool_twist.angular.cross(goal_WB.position - pose_WT.position);
  const Vec3 stretch = goal_WB.position - pose_WB_.position, twisted = turn_between(pose_WB_.orientation, goal_WB.orientation);

  // Contact damping towards what is touched; the grip's towards the tool.
  const double tau =
      load.stiffness_bound_n_per_m > 0.0
          ? 2.0 * kContactDampingRatio * std::sqrt(p.mass_kg / load.stiffness_bound_n_per_m)
          : 0.0;
  Mat6 damping = tau * load.stiffness, stiffness = load.stiffness;
  damping.diagonal() += stacked(Vec3::Constant(r), Vec3::Constant(r_turn));
  stiffness.diagonal() += stacked(Vec3::Constant(c), Vec3::Constant(c_turn));
  const Vec3 weight = p.mass_kg * p.gravity_m_per_s2, spin = twist_.angular;
  Vec6 push = stacked(load.wrench.force + weight + c * stretch + r * goal_velocity_W,
                      load.wrench.torque + arm.cross(weight) + c_turn * twisted + r_turn * tool_twist.angular);
  push += tau * load.stiffness_times_velocity;
  push -= stacked(p.mass_kg * spin.cross(spin.cross(arm)), spin.cross((central - p.mass_kg * across * across) * spin));
  const Vec6 old_velocity = stacked(twist_.linear, twist_.angular);
  // What moves with the tool or with an object is no stretch: springs see the way relative to it.
  Vec6 spring_ahead = load.stiffness_times_velocity;
  spring_ahead += stacked(c * goal_velocity_W, c_turn * tool_twist.angular);
  const Mat6 left = mass + dt_s * damping + (dt_s * dt_s) * stiffness;
  const Vec6 velocity = left.ldlt().solve(mass * old_velocity + dt_s * push + (dt_s * dt_s) * spring_ahead);
  if (!velocity.allFinite()) {  // nothing that can be stood on: it stops where it is
    twist_ = {};
    return {};
  }
  twist_ = {velocity.head<3>(), velocity.tail<3>()};
  cut(twist_.linear, kMaxSpeed), cut(twist_.angular, kMaxSpin);
  pose_WB_.position += dt_s * twist_.linear;
  const Vec3 step = dt_s * twist_.angular;
  if (const double angle = step.norm(); angle > 0.0)
    pose_WB_.orientation = (Quat(Eigen::AngleAxisd(angle, step / angle)) * pose_WB_.orientation).normalized();

  BodyGrip grip;
  // What acts on the tool is what acted on the body over this step: a body that is a step ahead of its tool would push it on.
  const Vec3 stretch_after = stretch + dt_s * (goal_velocity_W - twist_.linear);
  const Vec3 twisted_after = twisted + dt_s * (tool_twist.angular - twist_.angular);
  const Vec3 on_body = c * stretch_after + r * (goal_velocity_W - twist_.linear);
  const Vec3 turn_body = c_turn * twisted_after + r_turn * (tool_twist.angular - twist_.angular);
  const Vec3 lever = goal_WB.position - pose_WT.position;
  grip.wrench = {-on_body, -turn_body - lever.cross(on_body)};
  const Mat3 lever_across = cross_matrix(lever);
  grip.stiffness.topLeftCorner<3, 3>() = c * Mat3::Identity();
  grip.stiffness.topRightCorner<3, 3>() = -c * lever_across;
  grip.stiffness.bottomLeftCorner<3, 3>() = c * lever_across;
  grip.stiffness.bottomRightCorner<3, 3>() = c_turn * Mat3::Identity() - c * lever_across * lever_across;
  grip.stiffness_bound_n_per_m = c;
  const Vec6 now = stacked(twist_.linear, twist_.angular);
  energy_j_ = 0.5 * now.dot(mass * now) - weight.dot(pose_WB_ * shape_.centre) +
              0.5 * (c * stretch_after.squaredNorm() + c_turn * twisted_after.squaredNorm());
  return grip;
}

}  // namespace voxtouch::effects
