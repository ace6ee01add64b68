#include "core/effects/guide_law.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/types/smoothstep.hpp"

namespace voxtouch::effects {
namespace {

constexpr double kRelease = 1.0;  // index of the word

/// Effective limit F: while parameters ramp, the slope at the release must not exceed k.
double counted_limit(const GuideLaw& law) noexcept {
  return std::min(law.limit_n, law.stiffness_n_per_m * law.range_m / 3.0);
}

/// The spring up to its limit, without release.
GuideForce limited_spring(double k, double limit, double s) noexcept {
  const double w = limit / k, bend = s - 0.5 * w;
  if (bend <= 0.0)
    return {k * s, k, k, 0.5 * k * s * s};
  if (bend < w) {
    const double force = k * s - 0.5 * k * bend * bend / w;
    return {force, k * (1.0 - bend / w), force / s,
            0.5 * k * s * s - k * bend * bend * bend / (6.0 * w)};
  }
  return {limit, 0.0, limit / s, k * w * w * 23.0 / 24.0 + limit * (s - 1.5 * w)};
}

}  // namespace

GuideForce guide_force(const GuideLaw& law, double s) noexcept {
  const double limit = counted_limit(law), k = law.stiffness_n_per_m;
  if (!(k > 0.0 && limit > 0.0))
    return {};
  const double half = 0.5 * law.range_m;
  if (s <= half)
    return limited_spring(k, limit, s);
  GuideForce out = limited_spring(k, limit, half);
  const double t = std::min(1.0, (s - half) / half);
  out.force_n = limit * (1.0 - smoothstep(0.0, 1.0, t));
  out.slope_n_per_m = -6.0 * limit * t * (1.0 - t) / half;
  out.per_metre_n_per_m = out.force_n / s;
  out.potential_j += limit * half * (t - t * t * t + 0.5 * t * t * t * t);
  return out;
}

double guide_depth_j(const GuideLaw& law) noexcept {
  if (!std::isfinite(law.range_m))
    return std::numeric_limits<double>::infinity();
  return guide_force(law, law.range_m).potential_j;
}

double guide_potential_j(const GuideLaw& law, double from_guide_j) noexcept {
  return std::isfinite(law.range_m) ? from_guide_j - guide_depth_j(law) : from_guide_j;
}

void pull_to_guide(const GuideLaw& law, const Vec3& away, const Mat3& constrained,
                   EffectForce& sum) noexcept {
  const double s = away.norm();
  const GuideForce at = guide_force(law, s);
  sum.potential_j += guide_potential_j(law, at.potential_j);
  sum.wrench.force -= at.per_metre_n_per_m * (constrained * away);
  Mat3 bent = at.per_metre_n_per_m * Mat3::Identity();
  // If f' = f / s, as for an ideal spring, the direction has no influence and need not exist.
  if (const double more = std::max(at.slope_n_per_m, 0.0) - at.per_metre_n_per_m; more != 0.0) {
    const Vec3 u = away / s;
    bent += more * u * u.transpose();
  }
  sum.stiffness.topLeftCorner<3, 3>() += constrained * bent * constrained;
  sum.stiffness_bound_n_per_m += std::max(std::abs(at.slope_n_per_m), at.per_metre_n_per_m);
}

GuideLaw guide_law(const EffectValues& values) noexcept {
  GuideLaw law{values.number(kGuideStiffness), values.number(kGuideLimit)};
  if (values.number(kGuideBeyond) == kRelease)
    law.range_m = values.number(kGuideRange);
  return law;
}

std::string check_guide(const EffectValues& values) {
  const double range = values.number(kGuideRange);
  if (values.number(kGuideBeyond) != kRelease)
    return range > 0.0 ? "'range_m' requires 'beyond: release'" : "";
  // In a form that accepts a stiffness of 0 only without a force.
  const double least = 3.0 * values.number(kGuideLimit);
  if (range > 0.0 && range * values.number(kGuideStiffness) >= least * (1.0 - 1e-12))
    return {};
  return fmt::format("'range_m' is {:g}, minimum 3 limit_n / stiffness_n_per_m = {:g} m", range,
                     least / values.number(kGuideStiffness));
}

EffectBound guide_bound(const EffectValues& values) {
  const GuideLaw law = guide_law(values);
  return {.stiffness_n_per_m = law.stiffness_n_per_m,
          .force_n = law.limit_n,
          .potential_j = guide_depth_j(law)};
}

}  // namespace voxtouch::effects
