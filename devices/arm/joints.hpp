#pragma once
/// Common vector types of arms with seven joints.
#include "core/types/geometry.hpp"

namespace voxtouch::arm {

using Joints = Eigen::Matrix<double, 7, 1>;  ///< rad, rad/s or Nm
/// [linear; angular] of the tool over joint rates, base axes.
using Jacobian = Eigen::Matrix<double, 6, 7>;

/// Joint torque that gives `wrench` (base axes, about the tool's origin): J^T F.
inline Joints joint_torque(const Jacobian& jacobian, const Wrench& wrench) noexcept {
  Vec6 stacked;
  stacked << wrench.force, wrench.torque;
  return jacobian.transpose() * stacked;
}

}  // namespace voxtouch::arm
