// A guide to a plane: holds the tool's origin on it, or out of the half-space behind it.
#include <algorithm>
#include <cmath>

#include "core/effects/guide_law.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kPoint = kGuideOwn, kNormal, kSides };
constexpr double kOne = 1.0;  // index of the word

constexpr auto kParameters = guide_rows(
    row::place("point", "Point of the plane, in W [m]."),
    row::direction("normal",
                   "Normal of the plane, in W. With `sides: one` it points to the free side."),
    row::word("sides", "both one",
              "both: the plane pulls from either side. one: only from behind."));

bool one_sided(const EffectValues& values) noexcept { return values.number(kSides) == kOne; }

class GuidePlane final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const GuideLaw law = guide_law(values);
    const Vec3 normal = values.vector(kNormal);
    const double height = normal.dot(frame.tool.position - values.vector(kPoint));
    if (one_sided(values) && height >= 0.0)
      return;
    const GuideForce at = guide_force(law, std::abs(height));
    // A normal that ramps is shorter than 1, and so is the gradient of the height.
    sum.wrench.force -= std::copysign(at.force_n, height) * normal;
    sum.stiffness.topLeftCorner<3, 3>() +=
        std::max(at.slope_n_per_m, 0.0) * normal * normal.transpose();
    sum.stiffness_bound_n_per_m += std::abs(at.slope_n_per_m);
    sum.potential_j += one_sided(values) ? at.potential_j : guide_potential_j(law, at.potential_j);
  }
};

}  // namespace

extern const EffectKind kGuidePlane = {
    .name = "guide_plane",
    .summary = "Pulls the tool's origin to a plane, or keeps it on one side, with a limited force.",
    .equations =
        "U = phi(|h|), h the height over the plane; with sides: one U = phi(max(0, -h)) (forbidden "
        "region); F = -grad "
        "U, phi as of guide_point. |dF/dx| <= k along the normal, 0 along the plane. Conservative; "
        "with sides: one U "
        "is 0 on the free side. Stable for k < b / (T/2 + t_d) (Colgate and Schenkel 1997), b the "
        "damping of hand and "
        "device.",
    .energy = EnergyBehaviour::kConservative,
    .parameters = kParameters,
    .bound = guide_bound,
    .check = check_guide,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<GuidePlane>()); },
    .expected_ns = 60.0,
};

}  // namespace voxtouch::effects
