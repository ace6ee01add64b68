#include "devices/arm/simulated/arm_dynamics.hpp"

#include <cmath>

namespace voxtouch::arm_sim {
namespace {

/// Spatial inertia about the base's origin, in base axes: mass, first moment, rotational inertia.
/// Inertias of rigidly connected bodies add up. (Featherstone's spatial notation; motions are
/// [angular; velocity of the point at the base's origin].)
struct Inertia {
  double mass = 0.0;
  Vec3 moment = Vec3::Zero();
  Mat3 rotational = Mat3::Zero();

  void add(double m, const Vec3& centre, const Mat3& about_centre) noexcept {
    mass += m;
    moment += m * centre;
    rotational +=
        about_centre + m * (centre.squaredNorm() * Mat3::Identity() - centre * centre.transpose());
  }
  void add(const Inertia& other) noexcept {
    mass += other.mass, moment += other.moment, rotational += other.rotational;
  }
};

struct Spatial {
  Vec3 angular = Vec3::Zero(), linear = Vec3::Zero();
  Spatial operator+(const Spatial& b) const noexcept {
    return {angular + b.angular, linear + b.linear};
  }
  Spatial operator*(double s) const noexcept { return {s * angular, s * linear}; }
  double dot(const Spatial& b) const noexcept {
    return angular.dot(b.angular) + linear.dot(b.linear);
  }
};

Spatial operator*(const Inertia& i, const Spatial& v) noexcept {
  return {i.rotational * v.angular + i.moment.cross(v.linear),
          i.mass * v.linear - i.moment.cross(v.angular)};
}
Spatial cross_motion(const Spatial& v, const Spatial& m) noexcept {
  return {v.angular.cross(m.angular), v.angular.cross(m.linear) + v.linear.cross(m.angular)};
}
Spatial cross_force(const Spatial& v, const Spatial& f) noexcept {
  return {v.angular.cross(f.angular) + v.linear.cross(f.linear), v.angular.cross(f.linear)};
}

Mat3 in_base(const Mat3& rotation, const Vec3& principal) noexcept {
  return rotation * principal.asDiagonal() * rotation.transpose();
}

/// R <- R * rotation about the joint's axis.
void rotate(Mat3& r, Axis axis, double angle) noexcept {
  const double c = std::cos(angle), s = std::sin(angle);
  const bool about_y = axis == Axis::kY || axis == Axis::kMinusY,
             backwards = axis == Axis::kMinusZ || axis == Axis::kY;
  const int second = about_y ? 2 : 1;
  const Vec3 first = r.col(0), other = backwards ? Vec3(-r.col(second)) : Vec3(r.col(second));
  r.col(0) = c * first + s * other;
  const Vec3 rotated = c * other - s * first;
  r.col(second) = backwards ? Vec3(-rotated) : rotated;
}

/// A joint's axis in the base.
Vec3 axis_of(const Mat3& rotation, Axis axis) noexcept {
  switch (axis) {
    case Axis::kZ:
      return rotation.col(2);
    case Axis::kMinusZ:
      return -rotation.col(2);
    case Axis::kY:
      return rotation.col(1);
    case Axis::kMinusY:
      return -rotation.col(1);
  }
  return Vec3::Zero();
}

}  // namespace

std::array<ArmDynamics::Frame, 7> ArmDynamics::links(const arm::Joints& q) const noexcept {
  std::array<Frame, 7> frames;
  Mat3 rotation = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
  for (std::size_t i = 0; i < 7; ++i) {
    const JointPlace& joint = bodies_.joints[i];
    origin += rotation * joint.from_last_m;
    const Vec3 axis = axis_of(rotation, joint.axis);
    rotate(rotation, joint.axis, q[static_cast<Eigen::Index>(i)]);
    frames[i] = {rotation, origin, axis};
  }
  return frames;
}

ArmDynamics::Terms ArmDynamics::at(const arm::Joints& q, const arm::Joints& rate,
                                   const TipLoad& load) const noexcept {
  const std::array<Frame, 7> frames = links(q);
  Terms terms;
  terms.tool = Pose{frames[6].origin, Quat(frames[6].rotation)} * pose_FT_;
  const Vec3& tip = terms.tool.position;

  // Outward: velocities and their accelerations (recursive Newton-Euler with q'' = 0).
  std::array<Spatial, 7> axes, forces;
  std::array<Inertia, 7> bodies;
  Spatial velocity, acceleration;
  for (std::size_t i = 0; i < 7; ++i) {
    const Frame& f = frames[i];
    const Link& link = bodies_.links[i];
    bodies[i].add(link.mass_kg, f.rotation * link.centre_m + f.origin,
                  in_base(f.rotation * link.axes, link.inertia_kg_m2));
    axes[i] = {f.axis, f.origin.cross(f.axis)};
    const double speed = rate[static_cast<Eigen::Index>(i)];
    velocity = velocity + axes[i] * speed;
    acceleration = acceleration + cross_motion(velocity, axes[i]) * speed;
    Inertia moved = bodies[i];
    if (i == 6)
      moved.add(load.mass_kg, tip, load.inertia_kg_m2 * Mat3::Identity());
    forces[i] = moved * acceleration + cross_force(velocity, moved * velocity);
  }
  terms.twist = {velocity.linear + velocity.angular.cross(tip), velocity.angular};

  // Inward: forces sum to c, weights to g, bodies to the composites of M.
  Spatial force;
  Inertia arm, composite;
  composite.add(load.mass_kg, tip, load.inertia_kg_m2 * Mat3::Identity());
  for (std::size_t i = 7; i-- > 0;) {
    const auto row = static_cast<Eigen::Index>(i);
    force = force + forces[i];
    arm.add(bodies[i]);
    composite.add(bodies[i]);
    terms.coriolis[row] = axes[i].dot(force);
    terms.gravity[row] =
        kGravity * frames[i].axis.cross(arm.moment - arm.mass * frames[i].origin).z();
    const Spatial momentum = composite * axes[i];
    for (std::size_t j = 0; j <= i; ++j) {
      const auto col = static_cast<Eigen::Index>(j);
      terms.mass(row, col) = terms.mass(col, row) = axes[j].dot(momentum);
    }
    terms.jacobian.col(row) << axes[i].linear + frames[i].axis.cross(tip), frames[i].axis;
  }
  terms.mass.diagonal() += bodies_.rotor_kg_m2;
  return terms;
}

}  // namespace voxtouch::arm_sim
