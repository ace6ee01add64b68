// A magnet: the tool's origin snaps to a point when it is near.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/effects/effect.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kPoint, kRadius, kForce };

constexpr std::array kParameters = {
    row::place("point", "The point, in W [m]."),
    row::number("radius_m", 0.0005, 10.0, "Distance from which the force is zero [m]."),
    row::number("force_n", 0.0, 100.0, "Largest force [N], at 0.447 of the radius."),
};

/// F = 6 U0 r / R^2 (1 - q)^2 with q = r^2 / R^2 is largest at q = 1/5.
const double kDepth = 25.0 * std::sqrt(5.0) / 96.0;  ///< U0 / (F R)

class Magnet final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const double radius = values.number(kRadius);
    const Vec3 away = (frame.tool.position - values.vector(kPoint)) / radius;
    const double q = away.squaredNorm(), left = 1.0 - q;
    if (!(left > 0.0))
      return;
    const double depth = kDepth * values.number(kForce) * radius,
                 core = 6.0 * depth / (radius * radius);
    sum.potential_j -= depth * left * left * left;
    sum.wrench.force -= (core * radius * left * left) * away;
    // Across the radius core left^2, along it core left (1 - 5 q) = core left^2 - 4 core left q;
    // only the restoring part counts.
    const double across = core * left * left, along = core * left * (1.0 - 5.0 * q);
    Mat3 stiffness = across * Mat3::Identity();
    if (q > 0.2)
      stiffness -= (across / q) * away * away.transpose();
    else
      stiffness -= (4.0 * core * left) * away * away.transpose();
    sum.stiffness.topLeftCorner<3, 3>() += stiffness;
    sum.stiffness_bound_n_per_m += std::max(across, std::abs(along));
  }
};

EffectBound bound(const EffectValues& values) {
  const double force = values.number(kForce), radius = values.number(kRadius);
  return {.stiffness_n_per_m = 6.0 * kDepth * force / radius,
          .force_n = force,
          .potential_j = kDepth * force * radius};
}

}  // namespace

extern const EffectKind kMagnet = {
    .name = "magnet",
    .summary =
        "Pulls the tool's origin to a point within a radius. Pulled hard enough, it comes off.",
    .equations =
        "U = -U0 (1 - r^2/R^2)^3 within R, else 0 (twice differentiable at the rim); F = -grad U = "
        "-6 U0 / R^2 (1 - r^2/R^2)^2 r, at most F = force_n at r = R / sqrt(5), so U0 = 25 sqrt(5) "
        "/ 96 F R. |dF/dx| <= 3.494 F / R, reached at the point; beyond R / sqrt(5) the force "
        "falls with the distance (curvature down to -0.8 of that; not in the stiffness matrix). "
        "Conservative. Stable at the point for 3.494 F / R < b / (T/2 + t_d) (Colgate and Schenkel "
        "1997), b the damping of hand and device.",
    .energy = EnergyBehaviour::kConservative,
    .parameters = kParameters,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Magnet>()); },
    .expected_ns = 40.0,
};

}  // namespace voxtouch::effects
