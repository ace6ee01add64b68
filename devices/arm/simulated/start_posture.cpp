#include "devices/arm/simulated/start_posture.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

namespace voxtouch::arm_sim {
namespace {

constexpr int kIterations = 500;
constexpr double kReached = 1e-9;     // [m] and [rad]
constexpr double kLongestStep = 0.2;  // [rad] norm over the joints
constexpr double kMargin = 0.999;     // of a joint's limit

Vec6 displacement_to(const Pose& requested, const Pose& tool) {
  const Quat rotation = requested.orientation * tool.orientation.conjugate();
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::AngleAxisd angle(Quat(Eigen::Vector4d(sign * rotation.coeffs())));
  Vec6 displacement;
  displacement << requested.position - tool.position, angle.angle() * angle.axis();
  return displacement;
}

}  // namespace

arm::Joints start_posture(const std::function<Reach(const arm::Joints&)>& arm,
                          const Pose& requested, const arm::Joints& posture,
                          const arm::Joints& lowest_rad, const arm::Joints& highest_rad) {
  // A margin from the limits, so that no start is at a stop.
  const arm::Joints middle = 0.5 * (lowest_rad + highest_rad),
                    half = kMargin * (0.5 * (highest_rad - lowest_rad));
  const arm::Joints low = middle - half, high = middle + half;
  arm::Joints q = posture.cwiseMax(low).cwiseMin(high);
  for (int i = 0; i < kIterations; ++i) {
    const Reach state = arm(q);
    const Vec6 displacement = displacement_to(requested, state.tool);
    if (displacement.norm() < kReached)
      return q;
    const double damp = std::min(1e-2, 1e-2 * displacement.squaredNorm());
    const Mat6 square = state.jacobian * state.jacobian.transpose() + damp * Mat6::Identity();
    arm::Joints step = state.jacobian.transpose() * square.llt().solve(displacement);
    if (const double length = step.norm(); length > kLongestStep)
      step *= kLongestStep / length;
    q = (q + step).cwiseMax(low).cwiseMin(high);
  }
  const Vec3& p = requested.position;
  const Quat& o = requested.orientation;
  throw std::runtime_error(
      fmt::format("the arm cannot reach ({:.4g}, {:.4g}, {:.4g}) m with orientation (w x y z) "
                  "({:.4g}, {:.4g}, {:.4g}, {:.4g}) in its base frame; start the motion within its "
                  "reach, or set a closer posture",
                  p.x(), p.y(), p.z(), o.w(), o.x(), o.y(), o.z()));
}

}  // namespace voxtouch::arm_sim
