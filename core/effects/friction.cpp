// Coulomb friction with stiction: a bristle model whose bristles bend, slip and detach.
#include <array>
#include <cmath>

#include "core/effects/touch_point.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kCoulomb, kSticking, kStiffness, kMaxForce, kReach };

constexpr std::array kParameters = {
    row::number("coulomb", 0.0, 2.0, "Sliding friction over normal force [1]."),
    row::number("sticking", 1.0, 2.0, 1.0, "Sticking over sliding friction [1]."),
    row::number("stiffness_n_per_m", 10.0, 5000.0, 300.0,
                "Stiffness of the bristles while the tool sticks [N/m]."),
    row::number("most_n", 0.0, 200.0, 20.0, "Largest friction force per object [N]."),
    kReachParameter,
};

struct Law {
  double slides_n;  ///< friction of a sliding bristle
  double sticks_n;  ///< friction of a sticking bristle, >= slides_n
  double k;
};

/// `fraction` scales the force at which the bristles slip, not the stored force: half the friction
/// at a region's border is that of a surface half as rough.
Law law_at(double force_n, double fraction, const EffectValues& values) noexcept {
  const double most = fraction * values.number(kMaxForce),
               slides = fraction * values.number(kCoulomb) * force_n;
  return {std::min(slides, most), std::min(values.number(kSticking) * slides, most),
          values.number(kStiffness)};
}

/// State of the friction with one object.
struct Bristle {
  FollowedHeight height;
  Vec3 bend = Vec3::Zero();    ///< of the tip relative to the root, W, across the normal [m]
  Vec3 normal = Vec3::Zero();  ///< of the last sample; zero: none so far
  double torn = 0.0;           ///< 0: sticking with sticks_n, 1: sliding with slides_n

  void follow_contact(const Vec3& to, const Vec3& object_rotation) noexcept;
  void drag(const Vec3& displacement, const Law& law) noexcept;
};

/// Rotates the bend with the object and with the normal, along the shortest arc, without increasing
/// it.
void Bristle::follow_contact(const Vec3& to, const Vec3& object_rotation) noexcept {
  constexpr double kOpposite = -0.9;
  if (const double angle = object_rotation.norm(); angle > 0.0) {
    const Eigen::AngleAxisd rotation(angle, object_rotation / angle);
    bend = rotation * bend, normal = rotation * normal;
  }
  const double cosine = normal.dot(to);
  if (!(cosine > kOpposite) || normal.isZero(0.0)) {
    bend.setZero();  // reversed: another surface
  } else {
    bend -= (to.dot(bend) / (1.0 + cosine)) * (normal + to);
    bend -= to.dot(bend) * to;  // rounding
  }
  normal = to;
}

/// Bends by `displacement` (across the normal) and slips beyond the limit. While it detaches, its
/// limit falls by half of the slip, so the force falls with at most the slope k and never by
/// itself. It recovers by the same amount when it bends without slip.
void Bristle::drag(const Vec3& displacement, const Law& law) noexcept {
  const double slides = law.slides_n / law.k, sticks = law.sticks_n / law.k,
               mends = 2.0 * (sticks - slides);
  const double limit = sticks - (sticks - slides) * torn;
  bend += displacement;
  const double bent = bend.norm();
  if (bent <= limit) {
    torn = mends > 0.0 ? std::max(0.0, torn - displacement.norm() / mends) : 0.0;
    return;
  }
  const double remaining = std::max(slides, 2.0 * limit - bent);
  torn = mends > 0.0 ? std::min(1.0, torn + (bent - remaining) / mends) : 0.0;
  bend *= remaining / bent;
}

class Friction final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    const double reach = values.number(kReach), k = values.number(kStiffness);
    const double stiffer = stiffness_ > 0.0 && k > stiffness_
                               ? stiffness_ / k
                               : 1.0;  // keeps the force, generates no energy
    stiffness_ = k;
    step_.advance(frame.tool);
    bristles_.begin();
    for (const ObjectContact& touch : frame.contacts) {
      TouchPoint point;
      if (!find_touch(touch, frame.tool.position, reach, point))
        continue;
      Bristle* bristle = bristles_.find(touch.object);
      if (bristle == nullptr)
        continue;
      bristle->bend *= stiffer;
      const Vec3 arm =
          arm_to(point, bristle->height.follow(point.height_m, step_.most(reach)), reach);
      rub(frame, touch, point, arm, law_at(point.force_n, frame.fraction, values), *bristle);
      add(*bristle, arm, values, touch.contact->stiffness_bound_n_per_m, sum);
    }
    bristles_.end();
  }
  void reset() noexcept override {
    bristles_.clear();
    step_.forget();
  }

 private:
  void rub(const EffectFrame& frame, const ObjectContact& touch, const TouchPoint& point,
           const Vec3& arm, const Law& law, Bristle& bristle) const noexcept {
    const bool fresh = bristle.normal.isZero(0.0);
    bristle.follow_contact(point.normal, frame.dt_s * touch.twist.angular);
    if (fresh)
      return;
    const Vec3 displacement =
        step_.of_point(arm) - frame.dt_s * (touch.twist.linear + touch.twist.angular.cross(arm));
    bristle.drag(displacement - point.normal.dot(displacement) * point.normal, law);
  }

  /// The stiffness is k across the normal. While the bristle slips, the friction force follows the
  /// contact force by g newtons per metre of depth. This adds g/2 (z n' + n z'), which is below k z
  /// z' + g^2/(4k) n n' as long as k >= g/2.
  static void add(const Bristle& bristle, const Vec3& arm, const EffectValues& values,
                  double contact_n_per_m, EffectForce& sum) noexcept {
    const double k = values.number(kStiffness), sticking = values.number(kSticking);
    const Vec3 force = -k * bristle.bend, &n = bristle.normal;
    sum.wrench.force += force;
    sum.wrench.torque += arm.cross(force);
    const double g =
        (sticking > 1.0 ? 2.0 : 1.0) * sticking * values.number(kCoulomb) * contact_n_per_m;
    const double across = std::max(k, 0.5 * g), along = 0.25 * g * g / across;
    const Mat3 normal = n * n.transpose();
    sum.stiffness += seen_from_origin(across * (Mat3::Identity() - normal) + along * normal, arm);
    sum.stiffness_bound_n_per_m += std::hypot(k, g);
  }

  PerObject<Bristle> bristles_;
  ToolDisplacement step_;
  double stiffness_ = 0.0;  ///< of the last sample
};

/// Torque like that of the contact: a device without torque omits it.
EffectNeeds needs(const EffectValues&) { return {.contact = true, .orientation = true}; }

EffectBound bound(const EffectValues& values) {
  const double k = values.number(kStiffness), reach = values.number(kReach);
  return {.stiffness_n_per_m = k,
          .stiffness_nm_per_rad = k * reach * reach,
          .force_n = values.number(kMaxForce)};
}

}  // namespace

extern const EffectKind kFriction = {
    .name = "friction",
    .summary = "Dry friction: surfaces hold the tool until it slides, and resist sliding.",
    .equations =
        "F = -k z at the contact point, z the bristle deflection across the contact force N n: dz "
        "is the displacement relative to the object while |z| <= mu N / k; beyond, it slips at |z| "
        "= mu N / k (elastic-plastic: Prandtl; Hayward and Armstrong 2000). mu falls from sticking "
        "* coulomb to coulomb over 2 (sticking - 1) coulomb N / k of slip, so that dF/dx >= -k, "
        "and recovers over the same deflection. z rotates with n and the object. The law depends "
        "on displacement, not on time: at rest F is constant. It generates no energy while the "
        "object rests: k z^2 / 2 is stored and never grows with N; gain and region scale mu, not "
        "k. Stiffness: k; while slipping, mu times the contact's between depth and force.",
    .energy = EnergyBehaviour::kDissipative,
    .scales_inside = true,
    .friction = [](const EffectValues& values) { return values.number(kCoulomb); },
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<Friction>()); },
    .expected_ns = 120.0,
};

}  // namespace voxtouch::effects
