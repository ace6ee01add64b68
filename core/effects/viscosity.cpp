// Viscosity of a medium: the tool moves as through oil.
#include <array>

#include "core/effects/touch_point.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kDamping, kRotation };

constexpr std::array kParameters = {
    row::number("damping_ns_per_m", 0.0, 100.0, "Drag of the tool's origin [Ns/m]."),
    row::number("damping_nms_per_rad", 0.0, 10.0, 0.0,
                "Drag of rotation [Nms/rad]. It needs a device that gives torque."),
};

class Viscosity final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    sum.wrench.force -= values.number(kDamping) * within_hand_speed(frame.twist.linear);
    sum.wrench.torque -= values.number(kRotation) * frame.twist.angular;
  }
};

EffectNeeds needs(const EffectValues& values) {
  return {.twist = true, .torque = values.number(kRotation) > 0.0};
}

EffectBound bound(const EffectValues& values) {
  const double damping = values.number(kDamping);
  return {.damping_ns_per_m = damping,
          .damping_nms_per_rad = values.number(kRotation),
          .force_n = damping * kFastestMPerS};
}

}  // namespace

extern const EffectKind kViscosity = {
    .name = "viscosity",
    .summary = "Viscous drag on the tool, the same everywhere.",
    .equations =
        "F = -b v up to 2 m/s, torque = -b_r w (Stokes). Dissipative. With delay t_d and a filter "
        "of lag L, a mass m is stable for b < (pi/2) m / (L + t_d); scenes above half of that are "
        "refused.",
    .energy = EnergyBehaviour::kDissipative,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Viscosity>()); },
    .expected_ns = 5.0,
};

}  // namespace voxtouch::effects
