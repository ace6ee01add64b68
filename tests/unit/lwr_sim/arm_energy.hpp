#pragma once
/// The arm's energies, by another method than its dynamics.
#include "devices/lwr/simulated/lwr_plant.hpp"

namespace voxtouch::lwr_sim {

/// Sum over links, rotors and load [J]; made from the links' velocities, not from M.
inline double kinetic_energy(const ArmDynamics& arm, const lwr::LwrJoints& q,
                             const lwr::LwrJoints& rate, const TipLoad& load = {}) {
  const std::array<ArmDynamics::Frame, 7> frames = arm.links(q);
  const auto speed_of = [&](const Vec3& point, std::size_t last) {
    Vec3 v = Vec3::Zero();
    for (std::size_t j = 0; j <= last; ++j)
      v += rate[static_cast<Eigen::Index>(j)] * frames[j].axis.cross(point - frames[j].origin);
    return v;
  };
  double twice = rate.cwiseAbs2().dot(arm.bodies().rotor_kg_m2);
  Vec3 angular = Vec3::Zero();
  for (std::size_t i = 0; i < 7; ++i) {
    const Link& link = arm.bodies().links[i];
    angular += rate[static_cast<Eigen::Index>(i)] * frames[i].axis;
    twice += link.mass_kg *
             speed_of(frames[i].rotation * link.centre_m + frames[i].origin, i).squaredNorm();
    twice += (frames[i].rotation.transpose() * angular).cwiseAbs2().dot(link.inertia_kg_m2);
  }
  const Vec3 tip = frames[6].rotation * arm.pose_FT().position + frames[6].origin;
  twice +=
      load.mass_kg * speed_of(tip, 6).squaredNorm() + load.inertia_kg_m2 * angular.squaredNorm();
  return 0.5 * twice;
}

/// Of the links, zero with all centres at the height of the base [J].
inline double potential_energy(const ArmDynamics& arm, const lwr::LwrJoints& q) {
  const std::array<ArmDynamics::Frame, 7> frames = arm.links(q);
  double sum = 0.0;
  for (std::size_t i = 0; i < 7; ++i)
    sum += arm.bodies().links[i].mass_kg * kGravity *
           (frames[i].rotation * arm.bodies().links[i].centre_m + frames[i].origin).z();
  return sum;
}

}  // namespace voxtouch::lwr_sim
