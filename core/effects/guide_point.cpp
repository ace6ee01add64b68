// A guide to a point: a spring of limited force pulls the tool's origin there.
#include "core/effects/guide_law.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kPoint = kGuideOwn };

constexpr auto kParameters = guide_rows(row::place("point", "The point, in W [m]."));

class GuidePoint final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    pull_to_guide(guide_law(values), frame.tool.position - values.vector(kPoint), Mat3::Identity(),
                  sum);
  }
};

}  // namespace

extern const EffectKind kGuidePoint = {
    .name = "guide_point",
    .summary = "Pulls the tool's origin to a point with a limited force.",
    .equations =
        "U = phi(|x - p|), F = -grad U: a spring k that goes over smoothly to the force limit F "
        "(virtual fixture, "
        "Rosenberg 1993), and with beyond: release back to nothing at R. |dF/dx| <= k. "
        "Conservative. Sampled with a "
        "delay t_d before a hand and device of damping b it stays stable for k < b / (T/2 + t_d) "
        "(Colgate and Schenkel "
        "1997).",
    .energy = EnergyBehaviour::kConservative,
    .parameters = kParameters,
    .bound = guide_bound,
    .check = check_guide,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<GuidePoint>()); },
    .expected_ns = 60.0,
};

}  // namespace voxtouch::effects
