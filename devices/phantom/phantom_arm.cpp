#include "devices/phantom/phantom_arm.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::phantom {

Vec3 phantom_tip(const PhantomGeometry& g, const Vec3& q) noexcept {
  const double reach = g.thigh_m * std::cos(q[1]) + g.shin_m * std::sin(q[2]);
  return {reach * std::sin(q[0]), g.shin_m - g.shin_m * std::cos(q[2]) + g.thigh_m * std::sin(q[1]),
          reach * std::cos(q[0]) - g.thigh_m};
}

Mat3 phantom_jacobian(const PhantomGeometry& g, const Vec3& q) noexcept {
  const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]);
  const double s3 = std::sin(q[2]), c3 = std::cos(q[2]);
  const double reach = g.thigh_m * c2 + g.shin_m * s3;
  Mat3 j;
  j << reach * c1, -g.thigh_m * s1 * s2, g.shin_m * s1 * c3,  //
      0.0, g.thigh_m * c2, g.shin_m * s3,                     //
      -reach * s1, -g.thigh_m * c1 * s2, g.shin_m * c1 * c3;
  return j;
}

Mat3 phantom_jacobian_rate(const PhantomGeometry& g, const Vec3& q, const Vec3& v) noexcept {
  const double s1 = std::sin(q[0]), c1 = std::cos(q[0]), s2 = std::sin(q[1]), c2 = std::cos(q[1]);
  const double s3 = std::sin(q[2]), c3 = std::cos(q[2]);
  const double reach = g.thigh_m * c2 + g.shin_m * s3;
  const double reach_rate = -g.thigh_m * s2 * v[1] + g.shin_m * c3 * v[2];
  Mat3 j;
  j << reach_rate * c1 - reach * s1 * v[0], -g.thigh_m * (c1 * s2 * v[0] + s1 * c2 * v[1]),
      g.shin_m * (c1 * c3 * v[0] - s1 * s3 * v[2]),  //
      0.0, -g.thigh_m * s2 * v[1], g.shin_m * c3 * v[2], -reach_rate * s1 - reach * c1 * v[0],
      g.thigh_m * (s1 * s2 * v[0] - c1 * c2 * v[1]), -g.shin_m * (s1 * c3 * v[0] + c1 * s3 * v[2]);
  return j;
}

std::optional<Vec3> phantom_joints(const PhantomGeometry& g, const Vec3& tip) noexcept {
  const double depth = tip.z() + g.thigh_m;
  const double reach = std::hypot(tip.x(), depth);
  const double height = tip.y() - g.shin_m;  // relative to the shoulder
  const double far = std::hypot(reach, height);
  // In a triangle of thigh, shin and `far`: the law of cosines.
  const double cosine =
      (g.thigh_m * g.thigh_m + far * far - g.shin_m * g.shin_m) / (2.0 * g.thigh_m * far);
  if (!(reach > 0.0 && std::abs(cosine) <= 1.0))
    return std::nullopt;  // also NaN
  const double thigh = std::atan2(height, reach) + std::acos(cosine);
  const double shin =
      std::atan2(reach - g.thigh_m * std::cos(thigh), g.thigh_m * std::sin(thigh) - height);
  return Vec3(std::atan2(tip.x(), depth), thigh, shin);
}

Quat phantom_shin(const Vec3& q) noexcept {
  return Quat(Eigen::AngleAxisd(q[0], Vec3::UnitY()) * Eigen::AngleAxisd(-q[2], Vec3::UnitX()));
}

// Ry(a) Rx(b) Rz(c), with a = -g0 (right is a rotation against +y), b = -g1, c = -g2 (clockwise for
// the operator).
Vec3 gimbal_angles(const Vec3& q, const Quat& orientation) noexcept {
  const Mat3 r = (phantom_shin(q).conjugate() * orientation).toRotationMatrix();
  const double sine = std::clamp(-r(1, 2), -1.0, 1.0);
  const double middle = std::asin(sine);
  if (std::abs(sine) >
      1.0 - 1e-12) {  // the outer axes coincide: the whole rotation is assigned to the first
    return {-std::atan2(-r(2, 0), r(0, 0)), -middle, 0.0};
  }
  return {-std::atan2(r(0, 2), r(2, 2)), -middle, -std::atan2(r(1, 0), r(1, 1))};
}

Quat stylus_orientation(const Vec3& q, const Vec3& gimbal) noexcept {
  return phantom_shin(q) * Quat(Eigen::AngleAxisd(-gimbal[0], Vec3::UnitY()) *
                                Eigen::AngleAxisd(-gimbal[1], Vec3::UnitX()) *
                                Eigen::AngleAxisd(-gimbal[2], Vec3::UnitZ()));
}

const arm::ArmDescription& phantom_description() {
  static const arm::ArmDescription description = [] {
    const PhantomGeometry g;
    const auto about = [](double angle_rad, const Vec3& axis) {
      return Quat(Eigen::AngleAxisd(angle_rad, axis));
    };
    constexpr double kHalfTurn = std::numbers::pi, kQuarterTurn = kHalfTurn / 2.0;
    constexpr double kAssumedRadS = 10.0, kAssumedNm = 1.8;  // 8.5 N at the end of the thigh
    // These rotate z to the joint axes +y, -x, -y and -z. Their rotation about z is chosen so that
    // no step between two of them has a pitch of 90 degrees, where the angles of URDF are singular.
    const Quat up = about(-kQuarterTurn, Vec3::UnitX()), left = about(-kQuarterTurn, Vec3::UnitY()),
               aside = about(kQuarterTurn, Vec3::UnitZ());
    const Quat down = about(kQuarterTurn, Vec3::UnitX()) * aside,
               away = about(kHalfTurn, Vec3::UnitX()) * aside;
    const Vec3 shoulder(0.0, g.shin_m, -g.thigh_m), elbow(0.0, g.shin_m, 0.0), tip = Vec3::Zero();
    struct Placed {
      std::string_view name;
      Pose in_d;  // at angles of 0
      double most_rad, torque_nm;
    };
    const std::array<Placed, kChainJoints> placed{
        {{"turret", {shoulder, up}, kHalfTurn, kAssumedNm},
         {"thigh", {shoulder, left}, kHalfTurn, kAssumedNm},
         {"elbow", {elbow, left}, kHalfTurn, kAssumedNm},
         {"gimbal_turn", {tip, down}, kHalfTurn, 0.0},
         {"gimbal_tilt", {tip, left}, kQuarterTurn, 0.0},
         {"gimbal_roll", {tip, away}, kHalfTurn, 0.0}}};
    arm::ArmDescription arm{.model = "phantom", .joints = {}, .flange = {}, .link_radius_m = 0.01};
    Pose before;
    for (const Placed& joint : placed) {
      arm.joints.push_back({joint.name, before.inverse() * joint.in_d, -joint.most_rad,
                            joint.most_rad, kAssumedRadS, joint.torque_nm});
      before = joint.in_d;
    }
    arm.flange = before.inverse();
    return arm;
  }();
  return description;
}

std::optional<std::array<double, kChainJoints>> phantom_chain(const PhantomGeometry& geometry,
                                                              const Vec3& tip,
                                                              const Quat& orientation) noexcept {
  const std::optional<Vec3> q = phantom_joints(geometry, tip);
  if (!q)
    return std::nullopt;
  const Vec3 gimbal = gimbal_angles(*q, orientation);
  return std::array{(*q)[0], (*q)[1], (*q)[2] - (*q)[1], gimbal[0], gimbal[1], gimbal[2]};
}

PhantomDynamics::PhantomDynamics(const PhantomGeometry& g, const PhantomInertia& p,
                                 double gravity) noexcept
    : geometry_(g),
      rotor_(p.rotor_kg_m2) {
  const double l1 = g.thigh_m, l2 = g.shin_m, ma = p.a_kg, mc = p.c_kg;
  const Vec3 &a = p.a_kg_m2, &c = p.c_kg_m2, &be = p.be_kg_m2, &df = p.df_kg_m2;
  const double thigh_masses = l1 * l1 * (4.0 * ma + mc),
               shin_masses = l2 * l2 * ma + 4.0 * p.l3_m * p.l3_m * mc;
  turret_ = 0.125 * (4.0 * (a.y() + a.z() + be.y() + be.z() + c.y() + c.z() + df.y() + df.z()) +
                     8.0 * p.base_yy_kg_m2 + thigh_masses + shin_masses);
  thigh_wave_ = 0.125 * (4.0 * (be.y() - be.z() + c.y() - c.z()) + thigh_masses);
  shin_wave_ = 0.125 * (4.0 * (a.y() - a.z() + df.y() - df.z()) - shin_masses);
  cross_ = l1 * (l2 * ma + p.l3_m * mc);
  thigh_ = be.x() + c.x() + 0.25 * thigh_masses;
  shin_ = a.x() + df.x() + 0.25 * shin_masses;
  thigh_weight_ = 0.5 * gravity * (2.0 * l1 * ma + 2.0 * p.l5_m * p.be_kg + l1 * mc);
  shin_weight_ = 0.5 * gravity * (l2 * ma + 2.0 * p.l3_m * mc - 2.0 * p.l6_m * p.df_kg);
}

Mat3 PhantomDynamics::mass(const Vec3& q) const noexcept {
  const double coupled = -0.5 * cross_ * std::sin(q[1] - q[2]);
  Mat3 m = Mat3::Zero();
  m(0, 0) = turret_ + thigh_wave_ * std::cos(2.0 * q[1]) + shin_wave_ * std::cos(2.0 * q[2]) +
            cross_ * std::cos(q[1]) * std::sin(q[2]);
  m(1, 1) = thigh_;
  m(2, 2) = shin_;
  m(1, 2) = m(2, 1) = coupled;
  m.diagonal() += rotor_;
  return m;
}

Mat3 PhantomDynamics::coriolis(const Vec3& q, const Vec3& v) const noexcept {
  // Half the derivatives of M11 by thigh and shin, and that of M23 by the difference of the angles.
  const double by_thigh =
      -thigh_wave_ * std::sin(2.0 * q[1]) - 0.5 * cross_ * std::sin(q[1]) * std::sin(q[2]);
  const double by_shin =
      -shin_wave_ * std::sin(2.0 * q[2]) + 0.5 * cross_ * std::cos(q[1]) * std::cos(q[2]);
  const double coupled = 0.5 * cross_ * std::cos(q[1] - q[2]);
  Mat3 c;
  c << by_thigh * v[1] + by_shin * v[2], by_thigh * v[0], by_shin * v[0],  //
      -by_thigh * v[0], 0.0, coupled * v[2],                               //
      -by_shin * v[0], -coupled * v[1], 0.0;
  return c;
}

Vec3 PhantomDynamics::gravity(const Vec3& q) const noexcept {
  return {0.0, thigh_weight_ * std::cos(q[1]), shin_weight_ * std::sin(q[2])};
}

double PhantomDynamics::potential(const Vec3& q) const noexcept {
  return thigh_weight_ * std::sin(q[1]) - shin_weight_ * std::cos(q[2]);
}

double PhantomDynamics::energy(const Vec3& q, const Vec3& v) const noexcept {
  return 0.5 * v.dot(mass(q) * v) + potential(q);
}

}  // namespace voxtouch::phantom
