#include "core/rendering/latched_rotation.hpp"

#include <algorithm>

#include "core/types/rotation_vector.hpp"

namespace voxtouch::rendering {

const Quat& LatchedRotation::follow(const Quat& hand, double dt_s) noexcept {
  if (!hand.coeffs().allFinite())
    return hand;
  const double own = known_ ? rotation_vector(hand_, hand).norm() : 0.0;
  const bool anew = !known_ || own > kJumpRad || !torque_.allFinite();
  hand_ = hand, known_ = true;
  if (anew)
    return tool_ = hand;
  const Vec3 left = rotation_vector(tool_, hand);
  const double against = torque_.dot(left);
  Vec3 rotation = left;
  if (against < 0.0) {
    const double part = against * against / (torque_.squaredNorm() * left.squaredNorm());
    rotation =
        std::max(0.0, 1.0 - 2.0 * part) * (left - (against / torque_.squaredNorm()) * torque_);
  }
  const double most = own + kCatchUpPerS * dt_s * left.norm(), angle = rotation.norm();
  if (against >= 0.0 && angle <= most + 1e-9)
    return tool_ = hand;
  if (angle > most)
    rotation *= most / angle;
  if (!(rotation.norm() > 0.0))
    return tool_;
  tool_ = (Quat(Eigen::AngleAxisd(rotation.norm(), rotation.normalized())) * tool_).normalized();
  return tool_;
}

}  // namespace voxtouch::rendering
