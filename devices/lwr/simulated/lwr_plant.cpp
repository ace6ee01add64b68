#include "devices/lwr/simulated/lwr_plant.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace voxtouch::lwr_sim {

ArmBodies lwr_bodies(double torque_feedback_gain) {
  if (!(torque_feedback_gain >= 1.0 && std::isfinite(torque_feedback_gain)))
    throw std::runtime_error(fmt::format("arm inertia: torque_feedback_gain is {}; it must be >= 1",
                                         torque_feedback_gain));
  using arm_sim::Axis;
  ArmBodies arm;
  // From one joint to the next along the stretched arm [m], and the axis of each.
  arm.joints = {{{Vec3(0.0, 0.0, 0.11), Axis::kZ},
                 {Vec3(0.0, 0.0, 0.2005), Axis::kMinusY},
                 {Vec3(0.0, 0.0, 0.20), Axis::kZ},
                 {Vec3(0.0, 0.0, 0.20), Axis::kY},
                 {Vec3(0.0, 0.0, 0.20), Axis::kZ},
                 {Vec3(0.0, 0.0, 0.19), Axis::kMinusY},
                 {Vec3(0.0, 0.0, 0.078), Axis::kZ}}};
  const Vec3 upper(0.01845, 0.00405, 0.01602);
  arm.links = {Link{2.7, Vec3(0.0, -0.06, 0.13), upper},
               Link{2.7, Vec3(0.0, 0.06, 0.07), upper},
               Link{2.7, Vec3(0.0, 0.06, 0.13), upper},
               Link{2.7, Vec3(0.0, -0.06, 0.07), upper},
               Link{1.7, Vec3(0.0, 0.0, 0.124), Vec3(0.01075, 0.00255, 0.00922)},
               Link{1.1, Vec3(0.0, 0.0, 0.0625), Vec3::Constant(0.002865)},
               Link{0.25, Vec3::Zero(), Vec3::Constant(4.17e-4)}};
  arm.rotor_kg_m2 << 3.19, 3.05, 1.98, 2.05, 0.787, 0.391, 0.394;
  arm.rotor_kg_m2 /= torque_feedback_gain;
  return arm;
}

PlantParameters lwr_plant(double torque_feedback_gain) {
  PlantParameters p;
  p.bodies = lwr_bodies(torque_feedback_gain);
  p.viscous_nms_per_rad << 1.0, 1.2, 0.9, 0.8, 0.5, 0.3, 0.2;
  p.viscous_nms_per_rad /= torque_feedback_gain;
  p.coulomb_nm << 0.5, 0.8, 0.4, 0.3, 0.2, 0.1, 0.05;
  p.coulomb_nm /= torque_feedback_gain;
  const lwr::LwrLimits limits = lwr::lwr_limits();
  p.torque_limit_nm = limits.torque_nm;
  p.highest_rad = limits.position_rad;
  p.lowest_rad = -limits.position_rad;
  p.brake_nm = 2.0 * limits.torque_nm;
  return p;
}

}  // namespace voxtouch::lwr_sim
