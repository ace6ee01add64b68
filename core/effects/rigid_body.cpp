#include "core/effects/rigid_body.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/types/clamp.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::effects {
namespace {

Vec6 stacked(const Vec3& a, const Vec3& b) noexcept { return (Vec6() << a, b).finished(); }

/// At the body's origin, W axes.
struct MassMatrix {
  Mat6 all;
  Mat3 inertia;  ///< its rotational block
};

/// `rotation`: rotation from B's axes to W's; `arm`: from the origin to the centre of mass, in W.
MassMatrix mass_matrix(const BodyShape& shape, double mass_kg, const Mat3& rotation,
                       const Vec3& arm) noexcept {
  const Mat3 across = cross_matrix(arm),
             central = mass_kg * (rotation * shape.inertia_m2 * rotation.transpose());
  MassMatrix mass;
  mass.inertia = central - mass_kg * across * across;
  mass.all.topLeftCorner<3, 3>() = mass_kg * Mat3::Identity();
  mass.all.topRightCorner<3, 3>() = -mass_kg * across;
  mass.all.bottomLeftCorner<3, 3>() = mass_kg * across;
  mass.all.bottomRightCorner<3, 3>() = mass.inertia;
  return mass;
}

/// Spring and damper to the grip position of the body; W axes.
struct Grip {
  double c, c_rotation;  ///< stiffness [N/m, Nm/rad]
  Mat6 damping;          ///< [Ns/m, Ns, Nms/rad]
  Pose goal_WB;
  Vec3 goal_velocity_W, spin_W;
  Vec3 stretch, twisted;  ///< from the body to the goal [m, rad]

  Grip(const BodyParameters& p, const Mat6& full_damping, double strength, const Pose& pose_WB,
       const Pose& pose_TB, const Pose& pose_WT, const Twist& tool_twist) noexcept
      : c(strength * p.grip_n_per_m),
        c_rotation(strength * p.grip_nm_per_rad),
        damping(strength * full_damping),
        goal_WB(pose_WT * pose_TB),
        goal_velocity_W(tool_twist.linear +
                        tool_twist.angular.cross(goal_WB.position - pose_WT.position)),
        spin_W(tool_twist.angular),
        stretch(goal_WB.position - pose_WB.position),
        twisted(rotation_vector(pose_WB.orientation, goal_WB.orientation)) {}

  /// Wrench on the tool after the body has moved by a step of `dt_s` at `twist`, and the energy of
  /// the springs [J]. It equals the wrench on the body during this step: a body that is one step
  /// ahead of its tool would push it.
  BodyGrip on_tool(const Pose& pose_WT, const Twist& tool_twist, const Twist& twist, double dt_s,
                   double& energy_j) const noexcept {
    const Vec3 stretch_after = stretch + dt_s * (goal_velocity_W - twist.linear);
    const Vec3 twisted_after = twisted + dt_s * (tool_twist.angular - twist.angular);
    const Vec6 damper =
        damping * stacked(goal_velocity_W - twist.linear, tool_twist.angular - twist.angular);
    const Vec3 on_body = c * stretch_after + damper.head<3>();
    const Vec3 torque_on_body = c_rotation * twisted_after + damper.tail<3>();
    const Vec3 lever = goal_WB.position - pose_WT.position;
    const Mat3 lever_across = cross_matrix(lever);
    BodyGrip grip;
    grip.wrench = {-on_body, -torque_on_body - lever.cross(on_body)};
    grip.stiffness.topLeftCorner<3, 3>() = c * Mat3::Identity();
    grip.stiffness.topRightCorner<3, 3>() = -c * lever_across;
    grip.stiffness.bottomLeftCorner<3, 3>() = c * lever_across;
    grip.stiffness.bottomRightCorner<3, 3>() =
        c_rotation * Mat3::Identity() - c * lever_across * lever_across;
    grip.stiffness_bound_n_per_m = c;
    energy_j = 0.5 * (c * stretch_after.squaredNorm() + c_rotation * twisted_after.squaredNorm());
    return grip;
  }
};

/// The square root of a symmetric positive semidefinite matrix, or its inverse; zero eigenvalues
/// stay zero.
Mat6 root(const Mat6& matrix, bool inverse) noexcept {
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(0.5 * (matrix + matrix.transpose()));
  const double least = 1e-12 * std::max(solver.eigenvalues()[5], 0.0);
  Vec6 roots = Vec6::Zero();
  for (int n = 0; n < 6; ++n) {
    const double value = solver.eigenvalues()[n];
    if (value > least)
      roots[n] = inverse ? 1.0 / std::sqrt(value) : std::sqrt(value);
  }
  return solver.eigenvectors() * roots.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

Mat6 grip_damping(const BodyShape& shape, const BodyParameters& p) noexcept {
  const Mat6 mass = mass_matrix(shape, p.mass_kg, Mat3::Identity(), shape.centre).all;
  const double weight = p.mass_kg * p.gravity_m_per_s2.norm() * shape.centre.norm();
  const Vec6 stiffness =
      stacked(Vec3::Constant(p.grip_n_per_m), Vec3::Constant(p.grip_nm_per_rad + weight));
  const Mat6 half = root(mass, false), under = root(mass, true);
  const Mat6 modes = under * stiffness.asDiagonal() * under;
  const Mat6 damping = 2.0 * p.grip_damping_ratio * half * root(modes, false) * half;
  return 0.5 * (damping + damping.transpose());
}

/// The damping of the grip, W axes; recomputed after parameter changes. `rotation`: rotation from
/// T's axes to W's.
Mat6 RigidBody::damping_W(const BodyParameters& p, const Mat3& rotation) noexcept {
  if (!damping_known_ || !(damped_ == p))
    damped_ = p, damping_ = grip_damping(shape_, p), damping_known_ = true;
  Mat6 both = Mat6::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = rotation;
  return both * damping_ * both.transpose();
}

void RigidBody::place(const Pose& pose, bool held) noexcept {
  pose_WB_ = pose, twist_ = {}, pose_TB_ = {}, held_ = held, placed_ = true;
  strength_ = coupling::Ramp(held ? 1.0 : 0.0);
  energy_j_ = 0.0;
}

void RigidBody::follow_hold(const Pose& pose_WT, bool hold, double grab_m, double dt_s) noexcept {
  if (hold && !held_ && (pose_WT.position - pose_WB_.position).norm() <= grab_m) {
    held_ = true;
    pose_TB_ = pose_WT.inverse() * pose_WB_;
    strength_ = coupling::Ramp(
        0.0);  // gripped as it lies: no initial force, independent of the previous grip
    strength_.head_for(1.0, kGripRampS);
  } else if (!hold && held_) {
    held_ = false;
    strength_.head_for(0.0, kGripRampS);
  }
  strength_.advance(dt_s);
}

BodyGrip RigidBody::step(const BodyLoad& load, const Pose& pose_WT, const Twist& tool_twist,
                         bool hold, double grab_m, const BodyParameters& p, double dt_s) noexcept {
  follow_hold(pose_WT, hold, grab_m, dt_s);
  const Mat3 rotation = pose_WB_.orientation.toRotationMatrix();
  const Vec3 arm = rotation * shape_.centre;
  const MassMatrix mass = mass_matrix(shape_, p.mass_kg, rotation, arm);
  const Grip grip(p, damping_W(p, rotation), strength_.now(), pose_WB_, pose_TB_, pose_WT,
                  tool_twist);

  // Contact damping relative to the touched object; grip damping relative to the tool.
  const double tau =
      load.stiffness_bound_n_per_m > 0.0
          ? 2.0 * kContactDampingRatio * std::sqrt(p.mass_kg / load.stiffness_bound_n_per_m)
          : 0.0;
  const Mat6 damping = tau * load.stiffness + grip.damping;
  Mat6 stiffness = load.stiffness;
  stiffness.diagonal() += stacked(Vec3::Constant(grip.c), Vec3::Constant(grip.c_rotation));
  const Vec3 weight = p.mass_kg * p.gravity_m_per_s2, spin = twist_.angular;
  Vec6 generalised_force =
      stacked(load.wrench.force + weight + grip.c * grip.stretch,
              load.wrench.torque + arm.cross(weight) + grip.c_rotation * grip.twisted);
  generalised_force += grip.damping * stacked(grip.goal_velocity_W, grip.spin_W);
  generalised_force += tau * load.stiffness_times_velocity;
  generalised_force -=
      stacked(p.mass_kg * spin.cross(spin.cross(arm)), spin.cross(mass.inertia * spin));
  // Motion together with the tool or an object does not stretch the springs: they act on the
  // relative displacement.
  Vec6 spring_ahead = load.stiffness_times_velocity;
  spring_ahead += stacked(grip.c * grip.goal_velocity_W, grip.c_rotation * tool_twist.angular);
  const Mat6 left = mass.all + dt_s * damping + (dt_s * dt_s) * stiffness;
  const Vec6 velocity = left.ldlt().solve(mass.all * stacked(twist_.linear, twist_.angular) +
                                          dt_s * generalised_force + (dt_s * dt_s) * spring_ahead);
  if (!velocity.allFinite()) {  // invalid velocity: the body stops
    twist_ = {};
    return {};
  }
  twist_ = {velocity.head<3>(), velocity.tail<3>()};
  clamp_length(twist_.linear, kMaxSpeed), clamp_length(twist_.angular, kMaxSpin);
  move(dt_s);
  double spring_j = 0.0;
  const BodyGrip on_tool = grip.on_tool(pose_WT, tool_twist, twist_, dt_s, spring_j);
  const Vec6 now = stacked(twist_.linear, twist_.angular);
  energy_j_ = 0.5 * now.dot(mass.all * now) - weight.dot(pose_WB_ * shape_.centre) + spring_j;
  return on_tool;
}

void RigidBody::move(double dt_s) noexcept {
  pose_WB_.position += dt_s * twist_.linear;
  const Vec3 step = dt_s * twist_.angular;
  if (const double angle = step.norm(); angle > 0.0)
    pose_WB_.orientation =
        (Quat(Eigen::AngleAxisd(angle, step / angle)) * pose_WB_.orientation).normalized();
}

}  // namespace voxtouch::effects
