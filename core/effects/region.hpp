#pragma once
/// Region of an effect: a weight over space, applied to any effect.
#include <variant>

#include "core/types/geometry.hpp"

namespace voxtouch::effects {

struct EverywhereRegion {
  bool operator==(const EverywhereRegion&) const = default;
};
struct SphereRegion {
  Vec3 centre = Vec3::Zero();
  double radius_m = 0.0;
  bool operator==(const SphereRegion&) const = default;
};  ///< W
struct BoxRegion {
  Pose pose;
  Vec3 size_m = Vec3::Zero();
  bool operator==(const BoxRegion&) const = default;
};  ///< centred at the pose, W

/// Weight 1 inside the shape, 0 beyond `blend_m` > 0 outside it, and a smoothstep of the distance
/// between: continuous with its first derivative.
struct Region {
  std::variant<EverywhereRegion, SphereRegion, BoxRegion> shape;
  double blend_m = 0.002;
  bool operator==(const Region&) const = default;
};

struct RegionWeight {
  double weight = 1.0;           ///< 0..1
  Vec3 gradient = Vec3::Zero();  ///< [1/m], W; at most 1.5 / blend
};

/// Weight at `x` in W. Real-time safe.
RegionWeight weight_at(const Region& region, const Vec3& x) noexcept;
/// Bounds of the weight's first [1/m] and second [1/m^2] derivatives: 1.5 / b and 6 / b^2 for the
/// smoothstep of a distance. Across it the bound is w' / distance, which is also at most 6 / b^2.
/// Zero for everywhere.
double slope_bound_per_m(const Region& region) noexcept;
double curvature_bound_per_m2(const Region& region) noexcept;

}  // namespace voxtouch::effects
