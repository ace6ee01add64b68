#include "core/scene/device_workspace.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace voxtouch::scene {
namespace {

/// Edges of the motion's box: of the way points, since it is straight between them, and of sampled
/// points of a circle.
Vec3 span_of(const Motion& motion) {
  if (motion.path.empty())
    return Vec3::Zero();
  Vec3 low = motion.path.front(), high = low;
  const auto take = [&](const Vec3& point) {
    low = low.cwiseMin(point), high = high.cwiseMax(point);
  };
  for (const Vec3& point : motion.path)
    take(point);
  if (motion.circle_centre && motion.speed_m_per_s > 0.0) {
    constexpr int kPoints = 256;
    const double radius = (*motion.circle_centre - motion.path.back()).norm(),
                 start = approach_duration(motion);
    const double two_rounds =
        4.0 * std::numbers::pi * radius / motion.speed_m_per_s;  // it begins slowly
    for (int n = 0; n <= kPoints; ++n)
      take(motion_at(motion, start + two_rounds * n / kPoints).position);
  }
  return high - low;
}

}  // namespace

std::string beyond_workspace(const Motion& motion, const Vec3& workspace_m,
                             std::string_view device) {
  const Vec3 span = span_of(motion);
  const double factor = span.cwiseQuotient(workspace_m).maxCoeff();
  if (!(factor > 1.0))
    return {};
  return fmt::format(
      "The motion needs {:.3g} x {:.3g} x {:.3g} m, the workspace of {} is {:.3g} x {:.3g} x "
      "{:.3g} m. Increase position_scale by a factor of {:.2g}",
      span.x(), span.y(), span.z(), device, workspace_m.x(), workspace_m.y(), workspace_m.z(),
      std::ceil(factor * 20.0) / 20.0);
}

}  // namespace voxtouch::scene
