// Viscosity of a medium: the tool moves as through oil.
#include <array>

#include "core/effects/effect.hpp"

namespace voxtouch {
namespace {

enum : std::size_t { kDamping, kTurning };

constexpr std::array kParameters = {
    EffectParameter{.name = "damping_ns_per_m",
                    .high = 100.0,
                    .meaning = "Force for each metre a second of the tool's origin [Ns/m]."},
    EffectParameter{.name = "damping_nms_per_rad",
                    .high = 10.0,
                    .standard = {{0.0, 0.0, 0.0}},
                    .meaning = "Torque for each radian a second [Nms/rad]; needs a device that gives torque."},
};

/// No hand moves a tool faster; beyond it the liquid grows thinner, so that its force has a bound.
constexpr double kFastestMPerS = 2.0;

Vec3 cut(const Vec3& v) noexcept {
  const double speed = v.stableNorm();
  return speed > kFastestMPerS ? Vec3(v * (kFastestMPerS / speed)) : v;
}

class Viscosity final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values, EffectPush& push) noexcept override {
    push.wrench.force -= values.number(kDamping) * cut(frame.twist.linear);
    push.wrench.torque -= values.number(kTurning) * frame.twist.angular;
  }
};

EffectNeeds needs(const EffectValues& values) {
  EffectNeeds needs;
  needs.twist = true;
  needs.torque = values.number(kTurning) > 0.0;
  return needs;
}

EffectBound bound(const EffectValues& values) {
  EffectBound bound;
  bound.force_n = values.number(kDamping) * kFastestMPerS;
  bound.damping_ns_per_m = values.number(kDamping), bound.damping_nms_per_rad = values.number(kTurning);
  return bound;
}

}  // namespace

extern const EffectKind kViscosity;
const EffectKind kViscosity = {
    .name = "viscosity",
    .says = "The tool moves as through a thick liquid, everywhere alike.",
    .equations =
        "F = -b v up to 2 m/s, torque = -b_r w (Stokes). Dissipative. Sampled with a delay t_d and behind a filter of lag L a mass "
        "m "
        "stays stable for b < (pi/2) m / (L + t_d); the scene is refused above half of that.",
    .energy = EnergyBehaviour::kDissipative,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Viscosity>()); },
    .expected_ns = 5.0,
};

}  // namespace voxtouch
