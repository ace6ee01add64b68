#include "core/effects/region.hpp"

#include "core/types/smoothstep.hpp"

namespace voxtouch::effects {
namespace {

/// From the nearest point of the shape to `x`; zero inside.
Vec3 beyond(const EverywhereRegion&, const Vec3&) noexcept { return Vec3::Zero(); }
Vec3 beyond(const SphereRegion& sphere, const Vec3& x) noexcept {
  const Vec3 arm = x - sphere.centre;
  const double distance = arm.norm();
  if (distance <= sphere.radius_m)
    return Vec3::Zero();
  return (1.0 - sphere.radius_m / distance) * arm;
}
Vec3 beyond(const BoxRegion& box, const Vec3& x) noexcept {
  const Vec3 local = box.pose.orientation.conjugate() * (x - box.pose.position);
  const Vec3 half = 0.5 * box.size_m;
  return box.pose.orientation * (local - local.cwiseMax(-half).cwiseMin(half));
}

bool everywhere(const Region& region) noexcept {
  return std::holds_alternative<EverywhereRegion>(region.shape);
}

}  // namespace

RegionWeight weight_at(const Region& region, const Vec3& x) noexcept {
  const Vec3 away = std::visit([&](const auto& shape) { return beyond(shape, x); }, region.shape);
  const double distance = away.norm();
  if (!(distance > 0.0))
    return {};
  if (distance >= region.blend_m)
    return {0.0, Vec3::Zero()};
  const double t = distance / region.blend_m;
  return {1.0 - smoothstep(0.0, 1.0, t),
          (-6.0 * t * (1.0 - t) / region.blend_m) * (away / distance)};
}

double slope_bound_per_m(const Region& region) noexcept {
  return everywhere(region) ? 0.0 : 1.5 / region.blend_m;
}
double curvature_bound_per_m2(const Region& region) noexcept {
  return everywhere(region) ? 0.0 : 6.0 / (region.blend_m * region.blend_m);
}

}  // namespace voxtouch::effects
