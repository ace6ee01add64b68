// Viscous damping during contact: surfaces that appear wet, thick or velvety.
#include <array>

#include "core/effects/touch_point.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kAlong, kAgainst, kFull, kReach };

constexpr std::array kParameters = {
    row::number("damping_ns_per_m", 0.0, 100.0, "Damping along the surface [Ns/m]."),
    row::number("normal_damping_ns_per_m", 0.0, 100.0, 0.0,
                "Damping along the surface's normal [Ns/m]."),
    row::number(
        "full_force_n", 0.01, 100.0, 0.5,
        "Normal force at which the damping is complete [N]. Below it the damping grows from 0."),
    kReachParameter,
};

class SurfaceDamping final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const double reach = values.number(kReach),
                 fraction = weight_of_each(frame, values.number(kFull));
    step_.advance(frame.tool);
    heights_.begin();
    for (const ObjectContact& touch : frame.contacts) {
      TouchPoint point;
      if (!find_touch(touch, frame.tool.position, reach, point))
        continue;
      FollowedHeight* height = heights_.find(touch.object);
      if (height == nullptr)
        continue;
      const Vec3 arm = arm_to(point, height->follow(point.height_m, step_.most(reach)), reach);
      add(frame, touch, point, arm, fraction, values, sum);
    }
    heights_.end();
  }
  void reset() noexcept override {
    heights_.clear();
    step_.forget();
  }

 private:
  /// The weight grows with the depth, by `slope` per metre, so the force changes by slope |b v|
  /// along a direction other than that of the depth. Half of it on every axis is an upper bound.
  static void add(const EffectFrame& frame, const ObjectContact& touch, const TouchPoint& point,
                  const Vec3& arm, double fraction, const EffectValues& values,
                  EffectForce& sum) noexcept {
    const Vec3 displacement =
        within_hand_speed(frame.twist.linear - touch.twist.linear +
                          (frame.twist.angular - touch.twist.angular).cross(arm));
    const double into = point.normal.dot(displacement);
    const Vec3 full = -values.number(kAlong) * (displacement - into * point.normal) -
                      values.number(kAgainst) * into * point.normal;
    const Vec3 force = fraction * smoothstep(0.0, values.number(kFull), point.force_n) * full;
    sum.wrench.force += force;
    sum.wrench.torque += arm.cross(force);
    const double slope =
        kSteepestStep / values.number(kFull) * touch.contact->stiffness_bound_n_per_m;
    const double coupling = (fraction < 1.0 ? 2.0 : 1.0) * slope *
                            full.norm();  // the fraction of each also changes with the others
    sum.stiffness += seen_from_origin(0.5 * coupling * Mat3::Identity(), arm);
    sum.stiffness_bound_n_per_m += coupling;
  }

  PerObject<FollowedHeight> heights_;
  ToolDisplacement step_;
};

EffectNeeds needs(const EffectValues&) {
  return {.twist = true, .contact = true, .orientation = true};
}

EffectBound bound(const EffectValues& values) {
  const double reach = values.number(kReach),
               damping = std::max(values.number(kAlong), values.number(kAgainst));
  return {.damping_ns_per_m = damping,
          .damping_nms_per_rad = damping * reach * reach,
          .force_n = damping * kFastestMPerS};
}

}  // namespace

extern const EffectKind kSurfaceDamping = {
    .name = "surface_damping",
    .summary = "Viscous resistance to sliding along a surface and, if set, to leaving it.",
    .equations =
        "F = -s(N) (b v_t + b_n v_n) at the contact point (Stokes), v its velocity relative to the "
        "object, s the smoothstep of the contact force N from 0 to full_force_n. Without contact F "
        "= 0; F is continuous. Over several objects the sum of s is at most 1. Dissipative while "
        "the objects rest. With delay t_d and a filter of lag L, a mass m is stable for b < (pi/2) "
        "m / (L + t_d). If N depends on depth, so does F: stiffness s'(N) b v times the contact's.",
    .energy = EnergyBehaviour::kDissipative,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<SurfaceDamping>()); },
    .expected_ns = 130.0,
};

}  // namespace voxtouch::effects
