// Texture: a relief displayed as forces along the surface.
#include <array>

#include "core/effects/texture_pattern.hpp"
#include "core/effects/touch_point.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kPattern, kWavelength, kForce, kDirection, kFull, kReach };
enum : int { kGrating, kNoise };

constexpr std::array kParameters = {
    EffectParameter{.name = "pattern",
                    .shape = ParameterShape::kWord,
                    .meaning = "grating: straight parallel ridges. noise: irregular bumps.",
                    .words = "grating noise"},
    row::number("wavelength_m", 0.0005, 0.1,
                "Distance between ridges, for noise between bumps on average [m]."),
    row::number("force_n", 0.0, 20.0, "Force along the surface at the largest slope [N]."),
    EffectParameter{.name = "direction",
                    .shape = ParameterShape::kDirection,
                    .standard = {{1.0, 0.0, 0.0}},
                    .meaning = "Direction across the ridges of a grating, in W."},
    row::number(
        "full_force_n", 0.01, 100.0, 0.5,
        "Normal force at which the relief is complete [N]. Below it the relief grows from 0."),
    kReachParameter,
};

/// A run-time change of the wavelength would move a relief far from W's origin by many ridges under
/// the tool. A new relief therefore starts after the old one has faded out.
class Relief {
 public:
  /// The present fraction of the relief's force.
  double follow(const EffectValues& values, double dt_s) noexcept {
    constexpr double kFadeS = 0.05;
    const double wavelength = values.number(kWavelength);
    const Vec3 direction = values.vector(kDirection);
    const bool same = wavelength == wavelength_ && direction == direction_;
    fraction_ = !known_ ? 1.0 : std::clamp(fraction_ + (same ? dt_s : -dt_s) / kFadeS, 0.0, 1.0);
    if (!known_ || fraction_ == 0.0)
      wavelength_ = wavelength, direction_ = direction;
    known_ = true;
    return fraction_;
  }
  void forget() noexcept { known_ = false; }
  double wavelength_m() const noexcept { return wavelength_; }
  PatternSample at(const Vec3& x, int pattern) const noexcept {
    return pattern == kGrating ? grating_at(x, wavelength_, direction_) : noise_at(x, wavelength_);
  }

 private:
  bool known_ = false;
  double fraction_ = 0.0, wavelength_ = 0.0;
  Vec3 direction_ = Vec3::Zero();
};

double bend_of(const EffectValues& values) noexcept {
  return static_cast<int>(values.number(kPattern)) == kGrating ? kGratingBend : kNoiseBend;
}

class Texture final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const double most = relief_.follow(values, frame.dt_s) * values.number(kForce);
    const double reach = values.number(kReach),
                 fraction = weight_of_each(frame, values.number(kFull));
    for (const ObjectContact& touch : frame.contacts) {
      TouchPoint point;
      if (!find_touch(touch, frame.tool.position, reach, point))
        continue;
      add(frame, touch, point, fraction * most, fraction < 1.0, values, sum);
    }
  }
  void reset() noexcept override { relief_.forget(); }

 private:
  void add(const EffectFrame& frame, const ObjectContact& touch, const TouchPoint& point,
           double most, bool shared, const EffectValues& values, EffectForce& sum) const noexcept {
    const Vec3& n = point.normal;
    const PatternSample relief = relief_.at(frame.tool.position + point.contact_centre,
                                            static_cast<int>(values.number(kPattern)));
    const Vec3 force = -most * smoothstep(0.0, values.number(kFull), point.force_n) *
                       (relief.slope - n.dot(relief.slope) * n);
    sum.wrench.force += force;
    sum.wrench.torque += point.contact_centre.cross(force);
    const double slope =
        kSteepestStep / values.number(kFull) * touch.contact->stiffness_bound_n_per_m;
    const double coupling = (shared ? 2.0 : 1.0) * slope * most;
    const double own = most * bend_of(values) / relief_.wavelength_m();
    sum.stiffness +=
        seen_from_origin((own + 0.5 * coupling) * Mat3::Identity(), point.contact_centre);
    sum.stiffness_bound_n_per_m += own + coupling;
  }

  Relief relief_;
};

EffectNeeds needs(const EffectValues&) { return {.contact = true}; }

EffectBound bound(const EffectValues& values) {
  const double reach = values.number(kReach), force = values.number(kForce);
  const double stiffness = force * bend_of(values) / values.number(kWavelength);
  return {.stiffness_n_per_m = stiffness,
          .stiffness_nm_per_rad = stiffness * reach * reach,
          .force_n = force,
          .energy_per_metre_j = force};
}

}  // namespace

extern const EffectKind kTexture = {
    .name = "texture",
    .summary = "Relief of ridges or bumps that pushes the tool along the surface.",
    .equations =
        "F = -A s(N) grad h across the normal at the contact centre, h in W with |grad h| <= 1, s "
        "the smoothstep of the contact force N from 0 to full_force_n (lateral force: Minsky 1995; "
        "Robles-De-La-Torre and Hayward 2001). On a flat surface with N >= full_force_n it is the "
        "potential A h and generates no energy; if N varies or the surface is curved, at most A "
        "joule per metre of path. Stiffness at most 2 pi A / wavelength (grating), 7.5 A / "
        "wavelength (noise), and A s'(N) times the contact's. At f samples per second a speed v is "
        "displayed correctly only for v / wavelength < f/2 (1 kHz, 1 mm: 0.5 m/s; ten samples a "
        "ridge: 0.1 m/s). A wavelength should be at least ten encoder steps.",
    .energy = EnergyBehaviour::kBounded,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Texture>()); },
    .expected_ns = 130.0,
};

}  // namespace voxtouch::effects
