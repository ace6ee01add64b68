#include "core/contact/tool_friction.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "core/contact/limits.hpp"

namespace voxtouch {
namespace {

/// The rows that push, as one patch.
struct Patch {
  double push_m = 0.0;  ///< sum of the pushes' sizes, over k
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double radius_m = 0.0;
};

double push_of(const ConstraintRow& row, const Vec6& delta) noexcept {
  return contact_limits::kRowStiffness * depth_after(row, delta);
}

Patch patch_of(std::span<const ConstraintRow> rows, const Vec6& delta) noexcept {
  Patch patch;
  for (const ConstraintRow& row : rows) {
    const double push = push_of(row, delta);
    patch.push_m += push;
    patch.centre += push * row.arm;
    patch.normal += push * row.normal();
  }
  const double length = patch.normal.norm();
  if (!(patch.push_m > 0.0 && length > 0.0)) return {};
  patch.centre /= patch.push_m;
  patch.normal /= length;
  for (const ConstraintRow& row : rows) {
    const Vec3 from_centre = row.arm - patch.centre;
    patch.radius_m += push_of(row, delta) * (from_centre - patch.normal * patch.normal.dot(from_centre)).norm();
  }
  patch.radius_m /= patch.push_m;
  return patch;
}

using Slip = Eigen::Matrix<double, 3, 6>;

/// y = slip * delta. A patch without an extent does not hold against turning.
Slip slip_of(const Patch& patch, double lever_m, int& count) noexcept {
  Slip slip = Slip::Zero();
  const Vec3 a = patch.normal.unitOrthogonal(), b = patch.normal.cross(a);
  slip.row(0) << a.transpose(), patch.centre.cross(a).transpose() / lever_m;
  slip.row(1) << b.transpose(), patch.centre.cross(b).transpose() / lever_m;
  const double turn = patch.radius_m / lever_m;
  count = turn > 1e-6 ? 3 : 2;
  if (count == 3) slip.row(2).tail<3>() = turn * patch.normal.transpose();
  return slip;
}

}  // namespace

EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring, double lever_m, double friction,
                              const EquilibriumStep& free) noexcept {
  if (!(friction > 0.0) || !free.pushed) return free;
  const Patch patch = patch_of(rows, free.delta);
  if (!(patch.push_m > 0.0)) return free;
  int count = 0;
  const Slip slip = slip_of(patch, lever_m, count);
  // Projector on the steps without slip, and the friction wrench that a slip of one costs, by the pseudo-inverse.
  Mat3 gram = slip * slip.transpose();
  if (count == 2) gram(2, 2) = 1.0;
  const Mat3 inverse = gram.inverse();
  const Mat6 stick = Mat6::Identity() - slip.transpose() * inverse * slip;
  EquilibriumStep held = equilibrium_step(rows, spring, &stick);

  Vec6 unheld = spring - held.delta;  // what neither spring nor rows balance
  double push_held = 0.0;
  for (const ConstraintRow& row : rows) {
    const double push = push_of(row, held.delta);
    unheld += push * row.jacobian;
    push_held += push;
  }
  const double needed = (inverse * (slip * unheld)).norm();
  const double at_most = friction * push_held;
  if (needed <= at_most) {
    held.iterations += free.iterations;
    held.hessian = stick * (held.hessian - Mat6::Identity()) * stick + Mat6::Identity();
    return held;
  }
  // needed (1 - slide) = friction (push_held + slide (patch.push_m - push_held))
  const double slide =
      std::clamp((needed - at_most) / (needed + friction * (patch.push_m - push_held)), 0.0, 1.0);
  EquilibriumStep step = free;
  step.delta = held.delta + slide * (free.delta - held.delta);
  step.iterations += held.iterations;
  return step;
}

}  // namespace voxtouch
