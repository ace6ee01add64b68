#include "core/contact/tool_friction.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::contact {
namespace {

/// The active rows as one contact patch.
struct Patch {
  double push_m = 0.0;  ///< sum of the force magnitudes, over k
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double radius_m = 0.0;
};

double push_of(const ConstraintRow& row, const Vec6& delta) noexcept {
  return limits::kRowStiffness * depth_after(row, delta);
}

Patch patch_of(std::span<const ConstraintRow> rows, const Vec6& delta, double lever_m) noexcept {
  Patch patch;
  for (const ConstraintRow& row : rows) {
    const double push = push_of(row, delta);
    patch.push_m += push;
    patch.centre += push * row.arm;
    patch.normal += push * row.normal();
  }
  const double length = patch.normal.norm();
  if (!(patch.push_m > 0.0 && length > 0.0))
    return {};
  patch.centre /= patch.push_m;
  patch.normal /= length;
  for (const ConstraintRow& row : rows) {
    const Vec3 from_centre = row.arm - patch.centre;
    patch.radius_m +=
        push_of(row, delta) * (from_centre - patch.normal * patch.normal.dot(from_centre)).norm();
  }
  patch.radius_m /= patch.push_m;
  if (!(patch.radius_m > limits::kMinPatch * lever_m))
    patch.radius_m = 0.0;  // a point does not resist rotation
  return patch;
}

Vec3 across(const Vec3& normal, const Vec3& v) noexcept { return v - normal * normal.dot(v); }

/// Relative distance from its limit at which a friction force holds with the full stiffness of the
/// spring.
constexpr double kFirmSlack = 0.5;

/// The step without slip.
EquilibriumStep sticking_step(std::span<const ConstraintRow> rows, const Vec6& spring,
                              double lever_m, const Patch& patch, const Vec6& free) noexcept {
  const Vec3& m = patch.normal;
  Restriction allowed;
  const Vec3 turn = patch.radius_m > 0.0 ? across(m, free.tail<3>()) : Vec3(free.tail<3>());
  allowed.from << -across(m, (turn / lever_m).cross(patch.centre)), turn;
  allowed.free.setZero();
  allowed.free.topLeftCorner<3, 3>() = m * m.transpose();
  EquilibriumStep sticking = equilibrium_step(rows, spring, &allowed);
  sticking.loose.topLeftCorner<3, 3>() = m * m.transpose();
  if (patch.radius_m > 0.0)
    sticking.loose.bottomRightCorner<3, 3>() -= m * m.transpose();
  return sticking;
}

}  // namespace

EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring,
                              double lever_m, double friction,
                              const EquilibriumStep& free) noexcept {
  if (!(friction > 0.0) || !free.pushed)
    return free;
  const Patch patch = patch_of(rows, free.delta, lever_m);
  if (!(patch.push_m > 0.0))
    return free;
  EquilibriumStep sticking = sticking_step(rows, spring, lever_m, patch, free.delta);
  sticking.iterations += free.iterations;

  Vec6 unbalanced = spring - sticking.delta;  // remainder that neither spring nor rows balance
  double push_sticking = 0.0;
  for (const ConstraintRow& row : rows) {
    const double push = push_of(row, sticking.delta);
    unbalanced += push * row.jacobian;
    push_sticking += push;
  }
  const double shift = across(patch.normal, unbalanced.head<3>()).norm();
  const double turn = patch.radius_m > 0.0
                          ? patch.normal.dot(unbalanced.tail<3>()) * lever_m / patch.radius_m
                          : 0.0;
  const double needed = std::hypot(shift, turn), at_most = friction * push_sticking;
  if (needed <= at_most) {
    // Near the limit the friction fades: encoder steps would make a sliding tool alternately stick
    // and slip, and damping depends on the stiffness.
    const double slack = smoothstep(0.0, kFirmSlack, at_most > 0.0 ? 1.0 - needed / at_most : 0.0);
    sticking.loose = Mat6::Identity() - slack * (Mat6::Identity() - sticking.loose);
    return sticking;
  }
  // needed (1 - slide) = friction (push_sticking + slide (patch.push_m - push_sticking))
  const double slide = std::clamp(
      (needed - at_most) / (needed + friction * (patch.push_m - push_sticking)), 0.0, 1.0);
  EquilibriumStep step = free;
  step.delta = sticking.delta + slide * (free.delta - sticking.delta);
  step.iterations = sticking.iterations;
  return step;
}

}  // namespace voxtouch::contact
