#include "devices/arm/posture_torque.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace voxtouch::arm {

Joints free_motion(const Jacobian& jacobian) noexcept {
  Joints motion;
  for (int skipped = 0; skipped < 7; ++skipped) {
    Mat6 rest;
    for (int col = 0, to = 0; col < 7; ++col)
      if (col != skipped)
        rest.col(to++) = jacobian.col(col);
    const double sign = skipped % 2 ? -1.0 : 1.0;
    motion[skipped] = sign * rest.partialPivLu().determinant();
  }
  return motion;
}

Joints posture_torque(const PostureRules& rules, const Jacobian& jacobian, const Joints& q,
                      const Joints& rate) noexcept {
  if (!jacobian.allFinite() || !q.allFinite() || !rate.allFinite())
    return Joints::Zero();
  const Joints motion = free_motion(jacobian);
  const double manipulability = motion.norm();
  if (!(manipulability > 1e-9))
    return Joints::Zero();
  const Joints n = motion / manipulability;
  const double along =
      n.dot(rules.stiffness_nm_per_rad * (rules.posture - q) - rules.damping_nms_per_rad * rate);
  const double fraction = std::min(1.0, manipulability / rules.min_manipulability);
  return fraction * std::clamp(along, -rules.max_torque_nm, rules.max_torque_nm) * n;
}

}  // namespace voxtouch::arm
