#include "devices/lwr/posture_torque.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace voxtouch::lwr {

LwrJoints free_motion(const LwrJacobian& jacobian) noexcept {
  LwrJoints motion;
  for (int left_out = 0; left_out < 7; ++left_out) {
    Mat6 rest;
    for (int col = 0, to = 0; col < 7; ++col)
      if (col != left_out) rest.col(to++) = jacobian.col(col);
    const double sign = left_out % 2 ? -1.0 : 1.0;
    motion[left_out] = sign * rest.partialPivLu().determinant();
  }
  return motion;
}

LwrJoints posture_torque(const PostureRules& rules, const LwrJacobian& jacobian, const LwrJoints& q,
                         const LwrJoints& rate) noexcept {
  if (!jacobian.allFinite() || !q.allFinite() || !rate.allFinite()) return LwrJoints::Zero();
  const LwrJoints motion = free_motion(jacobian);
  const double manipulability = motion.norm();
  if (!(manipulability > 1e-9)) return LwrJoints::Zero();
  const LwrJoints n = motion / manipulability;
  const double along = n.dot(rules.stiffness_nm_per_rad * (rules.posture - q) - rules.damping_nms_per_rad * rate);
  const double share = std::min(1.0, manipulability / rules.min_manipulability);
  return share * std::clamp(along, -rules.max_torque_nm, rules.max_torque_nm) * n;
}

}  // namespace voxtouch::lwr
