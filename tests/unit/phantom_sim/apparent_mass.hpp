#pragma once
#include <Eigen/LU>

#include "devices/phantom/phantom_arm.hpp"

namespace voxtouch::hd_sim {

/// Apparent mass along each axis of D [kg]: 1 / diag(J M^-1 J^T). Zero if the arm is stretched.
inline Vec3 apparent_mass(const phantom::PhantomDynamics& dynamics, const Vec3& joints) {
  const Mat3 j = phantom::phantom_jacobian(dynamics.geometry(), joints);
  const Vec3 mobility = (j * dynamics.mass(joints).inverse() * j.transpose()).diagonal();
  return mobility.unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
}

}  // namespace voxtouch::hd_sim
