// The dynamic object as a body that is carried, falls and rests. rigid_body.hpp computes its
// motion; the scene renderer calls it.
#include <array>
#include <cmath>

#include "core/effects/body.hpp"
#include "core/effects/effect.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t {
  kMass,
  kGravity,
  kGrip,
  kGripRotation,
  kGripDamping,
  kGrabButton,
  kGrabDistance
};

constexpr std::array kParameters = {
    row::number("mass_kg", 0.001, 100.0, "Mass of the body [kg]."),
    EffectParameter{.name = "gravity_m_per_s2",
                    .shape = ParameterShape::kVector,
                    .high = 100.0,
                    .standard = {{0.0, 0.0, -9.81}},
                    .meaning = "Gravity, in W [m/s^2]."},
    row::number("grip_n_per_m", 1.0, 1e4, 200.0,
                "Spring between hand and body while it is gripped [N/m]."),
    row::number("grip_nm_per_rad", 0.0, 100.0, 0.3,
                "Rotational spring [Nm/rad]. It also acts on devices without torque."),
    row::number("grip_damping_ratio", 0.1, 2.0, 1.0,
                "Damping ratio of each mode of spring and body [1]; 1: no overshoot."),
    row::number("grab_button", -1.0, 31.0, -1.0,
                "Button that grips the body while pressed, from 0; -1: always gripped."),
    row::number("grab_distance_m", 0.0, 10.0, 0.02,
                "Largest distance from tool to body at which the button grips it [m]."),
};

/// The body acts through its motion only and adds no force here.
class Body final : public Effect {
 public:
  void apply(const EffectFrame&, const EffectValues&, EffectForce&) noexcept override {}
};

EffectNeeds needs(const EffectValues&) {
  return {.twist = true, .orientation = true, .body = true};
}

EffectBound bound(const EffectValues& values) {
  const BodyParameters p = body_parameters(values);
  // Gripped off its origin, it also rotates the hand by its lever.
  const double lever =
      grab_button(values) < 0 ? 0.0 : p.grip_n_per_m * std::pow(grab_distance_m(values), 2);
  return {.stiffness_n_per_m = p.grip_n_per_m,
          .stiffness_nm_per_rad = p.grip_nm_per_rad + lever,
          .damping_ns_per_m = 2.0 * p.grip_damping_ratio * std::sqrt(p.grip_n_per_m * p.mass_kg)};
}

std::string check(const EffectValues& values) {
  const double button = values.number(kGrabButton);
  return button == std::floor(button) ? "" : "'grab_button' must be an integer >= -1";
}

}  // namespace

BodyParameters body_parameters(const EffectValues& values) noexcept {
  BodyParameters p;
  p.mass_kg = values.number(kMass);
  p.gravity_m_per_s2 = values.vector(kGravity);
  p.grip_n_per_m = values.number(kGrip), p.grip_nm_per_rad = values.number(kGripRotation);
  p.grip_damping_ratio = values.number(kGripDamping);
  return p;
}
int grab_button(const EffectValues& values) noexcept {
  return static_cast<int>(std::lround(values.number(kGrabButton)));
}
double grab_distance_m(const EffectValues& values) noexcept { return values.number(kGrabDistance); }

extern const EffectKind kBody = {
    .name = "body",
    .summary =
        "The tool has weight and inertia. It is carried on a spring, falls when released, and "
        "rests on contacts.",
    .equations =
        "(M + h D + h^2 K) v+ = M v + h (contact + effects + m g + grip), linearly implicit "
        "(Baraff and Witkin 1998), stable for any contact stiffness. The hand receives the grip's "
        "spring and damper only: F = -k (x_tool - x_body) - D (v_tool - v_body), D = 2 zeta M^1/2 "
        "(M^-1/2 K M^-1/2)^1/2 M^1/2, K including the weight's restoring torque. The grip's "
        "stiffness at the device is limited to the certified one; the weight is not. Conservative "
        "except for damping.",
    .energy = EnergyBehaviour::kBounded,
    .alone = true,
    .everywhere = true,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .check = check,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Body>()); },
    .expected_ns = 300.0,
};

}  // namespace voxtouch::effects
