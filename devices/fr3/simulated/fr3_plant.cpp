#include "devices/fr3/simulated/fr3_plant.hpp"

#include <Eigen/Eigenvalues>

namespace voxtouch::fr3_sim {
namespace {

using arm_sim::Axis;

/// A link as in the description: in the frame of its joint, whose x axis is that of the base at q =
/// 0.
struct Described {
  double mass_kg;
  Vec3 centre_m;
  double xx, xy, xz, yy, yz, zz;
  int quarter_turns;  ///< about x, of the joint's frame relative to the base at q = 0
};

Mat3 rotation_about_x(int quarters) {
  Mat3 r = Mat3::Identity();
  const double c = quarters % 2 == 0 ? (quarters == 2 ? -1.0 : 1.0) : 0.0,
               s = quarters % 2 == 0 ? 0.0 : quarters;
  r(1, 1) = r(2, 2) = c;
  r(1, 2) = -s, r(2, 1) = s;
  return r;
}

arm_sim::Link link_of(const Described& d) {
  const Mat3 rotation = rotation_about_x(d.quarter_turns);
  Mat3 inertia;
  inertia << d.xx, d.xy, d.xz, d.xy, d.yy, d.yz, d.xz, d.yz, d.zz;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(inertia);
  Mat3 axes = rotation * principal.eigenvectors();
  if (axes.determinant() < 0.0)
    axes.col(0) = -axes.col(0);
  return {d.mass_kg, rotation * d.centre_m, principal.eigenvalues(), axes};
}

}  // namespace

arm_sim::ArmBodies fr3_bodies(double torque_feedback_gain) {
  arm_sim::ArmBodies arm;
  arm.joints = {{{Vec3(0.0, 0.0, 0.333), Axis::kZ},
                 {Vec3::Zero(), Axis::kY},
                 {Vec3(0.0, 0.0, 0.316), Axis::kZ},
                 {Vec3(0.0825, 0.0, 0.0), Axis::kMinusY},
                 {Vec3(-0.0825, 0.0, 0.384), Axis::kZ},
                 {Vec3::Zero(), Axis::kMinusY},
                 {Vec3(0.088, 0.0, 0.0), Axis::kMinusZ}}};
  const std::array<Described, 7> described{{
      {2.9274653454, Vec3(4.128e-7, -0.0181251324, -0.0386035970), 0.023927316485, 1.33179e-5,
       -1.1404775e-4, 0.0224821613, -0.0019950321, 0.0063500983, 0},
      {2.9355370338, Vec3(0.0031828864, -0.0743221644, 0.0088146084), 0.0419389463, 2.0257332e-4,
       0.0040777842, 0.0251451489, -0.0042252158, 0.0617021447, -1},
      {2.2449013699, Vec3(0.0407015686, -0.0048200565, -0.0289730823), 0.0241014255, 0.0024046946,
       -0.0028562693, 0.0197405327, -0.0021042127, 0.0190444945, 0},
      {2.6155955791, Vec3(-0.0459100965, 0.0630492960, -0.0085187868), 0.0345299832, 0.0132255227,
       0.0101514300, 0.0288816219, -9.762834e-4, 0.0412547117, 1},
      {2.3271207594, Vec3(-0.0016039605, 0.0292536262, -0.0972965990), 0.0516102785, -0.0057151734,
       -0.0035673168, 0.0478772971, 0.0106739851, 0.0164236256, 0},
      {1.8170376524, Vec3(0.0597131221, -0.0410294666, -0.0101692726), 0.0054123336, 0.0061934564,
       0.0014219289, 0.0140583295, -0.0013140754, 0.0160808179, 1},
      {0.6271432862, Vec3(0.0045225817, 0.0086261921, -0.0161633251), 2.1092389e-4, -2.433299e-5,
       4.564480e-5, 1.7718568e-4, 8.744070e-5, 5.993191e-5, 2},
  }};
  for (std::size_t i = 0; i < arm.links.size(); ++i)
    arm.links[i] = link_of(described[i]);
  arm.rotor_kg_m2 << 0.605721456, 0.605721456, 0.462474144, 0.462474144, 0.205544064, 0.205544064,
      0.205544064;
  arm.rotor_kg_m2 /= torque_feedback_gain;
  return arm;
}

arm::Joints fr3_speed_limit() noexcept {
  arm::Joints limit;
  limit << 2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26;
  return limit;
}

arm_sim::PlantParameters fr3_plant(const Pose& pose_FT, double torque_feedback_gain) {
  arm_sim::PlantParameters p;
  p.bodies = fr3_bodies(torque_feedback_gain);
  // The last link's frame is that of the base at q = 0; the flange is below it, upside down.
  p.pose_FT = Pose{Vec3(0.0, 0.0, -fr3::Fr3Arm::kFlange), Quat(0.0, 1.0, 0.0, 0.0)} * pose_FT;
  p.viscous_nms_per_rad << 0.6, 0.6, 0.4, 0.4, 0.2, 0.15, 0.1;
  p.coulomb_nm << 0.3, 0.3, 0.25, 0.25, 0.12, 0.1, 0.06;
  p.torque_limit_nm << 87, 87, 87, 87, 12, 12, 12;
  p.lowest_rad << -2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159;
  p.highest_rad << 2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159;
  p.brake_nm = 2.0 * p.torque_limit_nm;
  return p;
}

}  // namespace voxtouch::fr3_sim
