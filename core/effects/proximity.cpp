// A force field around the static objects that repels the tool at a distance.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/effects/effect.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::effects {
namespace {

enum : std::size_t { kLimit, kRange, kSmoothing, kLever };

constexpr std::array kParameters = {
    row::number("limit_n", 0.0, 100.0,
                "Force if the tool's whole surface were at the object [N]. Each part contributes "
                "by its fraction of the area."),
    row::number("range_m", 0.0005, 1.0, "Distance from the surface at which the force begins [m]."),
    row::number("smoothing_m", 0.0005, 1.0, 0.002,
                "Length over which the field's edges are rounded [m], in whole voxels. Walls "
                "thinner than this are blurred."),
    row::number("lever_m", 0.0, 10.0, 0.0,
                "Largest distance of the tool from its origin [m]; 0: no torque. Above 0 the "
                "device must give torque."),
};

/// Bounds of |gradient| and h |curvature| of a smoothed distance; see ProximitySample.
const double kSteepest = std::sqrt(3.0);
constexpr double kBent = 6.0;

/// Potential p(d) of the whole tool at the distance d. The force -p' = F S(1 - |d| / R), with S the
/// smoothstep, is F at the surface. It is 0 from R on outside, and decreases again inside, where
/// contact takes over.
struct Layer {
  double potential_j = 0.0, force_n = 0.0;
  double slope_n_per_m = 0.0;  ///< p'': decrease of the force with d
};

Layer layer_at(double limit, double range, double d) noexcept {
  if (!(d < range))
    return {};
  const double u = std::max(0.0, 1.0 - std::abs(d) / range);
  const double work =
      limit * range *
      (u * u * u - 0.5 * u * u * u * u);  // from the border of the layer on this side
  const double slope = limit / range * 6.0 * u * (1.0 - u);
  return {d >= 0.0 ? work : limit * range - work, limit * smoothstep(0.0, 1.0, u),
          std::copysign(slope, d)};
}

/// Adds the tool's points one by one; arms in W axes.
class Sums {
 public:
  Sums(bool torque, EffectForce& sum) noexcept : torque_(torque), sum_(sum) {}

  void add(const Vec3& arm, double fraction, const Layer& layer,
           const ProximitySample& sample) noexcept {
    const Vec3 force = (fraction * layer.force_n) * sample.gradient;
    sum_.wrench.force += force;
    sum_.potential_j += fraction * layer.potential_j;
    // -dF/dx = p'' g g' + p' H, with p' = -force. Of the first term the restoring part is used. Of
    // the second, Gershgorin's diagonal, which is at least -p' |H| in every direction and exact for
    // flat walls.
    const Vec3 rows = sample.curvature.cwiseAbs().rowwise().sum();
    Mat3 stiffness = (fraction * layer.force_n) * Mat3(rows.asDiagonal());
    if (layer.slope_n_per_m > 0.0)
      stiffness += (fraction * layer.slope_n_per_m) * sample.gradient * sample.gradient.transpose();
    sum_.stiffness.topLeftCorner<3, 3>() += stiffness;
    sum_.stiffness_bound_n_per_m +=
        fraction * (std::abs(layer.slope_n_per_m) * sample.gradient.squaredNorm() +
                    layer.force_n * rows.maxCoeff());
    if (torque_)
      add_rotation(arm, force, stiffness);
  }

 private:
  void add_rotation(const Vec3& arm, const Vec3& force, const Mat3& stiffness) noexcept {
    sum_.wrench.torque += arm.cross(force);
    const Mat3 cross = cross_matrix(arm);
    sum_.stiffness.topRightCorner<3, 3>() -= stiffness * cross;
    sum_.stiffness.bottomLeftCorner<3, 3>() += cross * stiffness;
    sum_.stiffness.bottomRightCorner<3, 3>() -= cross * stiffness * cross;
    // The arm rotates under the force.
    sum_.stiffness.bottomRightCorner<3, 3>().diagonal().array() += arm.norm() * force.norm();
  }

  bool torque_;
  EffectForce& sum_;
};

class ProximityEffect final : public Effect {
 public:
  void apply(const EffectFrame& frame, const EffectValues& values,
             EffectForce& sum) noexcept override {
    if (frame.proximity == nullptr)
      return;
    const double limit = values.number(kLimit), range = values.number(kRange);
    Sums sums(values.number(kLever) > 0.0, sum);
    for (const ToolPoint& point : frame.tool_points) {
      const Vec3 arm = frame.tool.orientation * point.position;
      const ProximitySample sample = frame.proximity->at(frame.tool.position + arm);
      const Layer layer = layer_at(limit, range, sample.distance_m);
      if (layer.potential_j > 0.0)
        sums.add(arm, point.fraction, layer, sample);
    }
  }
};

EffectNeeds needs(const EffectValues& values) {
  EffectNeeds needs{.orientation = true,
                    .proximity_m = values.number(kRange),
                    .smoothing_m = values.number(kSmoothing)};
  if (values.number(kLever) > 0.0)
    needs.torque = true, needs.lever_m = values.number(kLever);
  return needs;
}

EffectBound bound(const EffectValues& values) {
  const double limit = values.number(kLimit), range = values.number(kRange),
               lever = values.number(kLever);
  EffectBound bound{
      .stiffness_n_per_m = 3.0 * 1.5 * limit / range + kBent * limit / values.number(kSmoothing),
      .force_n = kSteepest * limit,
      .potential_j = limit * range};
  if (lever > 0.0)
    bound.stiffness_nm_per_rad = lever * (lever * bound.stiffness_n_per_m + bound.force_n);
  return bound;
}

std::string check(const EffectValues& values) {
  return values.number(kSmoothing) > 4.0 * values.number(kRange)
             ? "'smoothing_m' must be at most four times 'range_m'"
             : "";
}

}  // namespace

extern const EffectKind kProximity = {
    .name = "proximity",
    .summary =
        "Pushes the tool away from static objects before contact. The force grows as the distance "
        "falls.",
    .equations =
        "U = sum a_i p(d(x_i)) over points x_i with fractions a_i of the tool's surface (sum 1), d "
        "the smoothed signed distance; F = -sum a_i p'(d) grad d, torque sum r_i x F_i; -p' = F "
        "S(1 - |d|/R), S the smoothstep (force field from outer layers, McNeely et al. 1999). |F| "
        "<= sqrt(3) F, |dF/dx| <= 3 (3/2) F / R + 6 F / h, h the smoothing; before a flat wall "
        "(3/2) F / R. Conservative; without torque, for motions without rotation. Stable for that "
        "bound below b / (T/2 + t_d) (Colgate and Schenkel 1997), b the damping of hand and "
        "device.",
    .energy = EnergyBehaviour::kConservative,
    .parameters = kParameters,
    .needs = needs,
    .bound = bound,
    .check = check,
    .make = [] { return std::unique_ptr<Effect>(std::make_unique<ProximityEffect>()); },
};

}  // namespace voxtouch::effects
