#include "core/exact/friction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/types/smoothstep.hpp"

namespace voxtouch::exact {
namespace {

constexpr double kMinPatch =
    1e-3;  // radius over lever: below, the contact is a point, free to turn
constexpr double kAlongRowSine = 1e-6;  // a row that the step along m neither opens nor closes
constexpr double kKeptM = 1e-10;
/// Relative distance from its limit at which a friction force holds with the full stiffness of the
/// spring.
constexpr double kFirmSlack = 0.5;

/// The contacts as one patch.
struct Patch {
  double force_m = 0.0;
  Vec3 centre = Vec3::Zero(), normal = Vec3::Zero();
  double radius_m = 0.0;
};

Vec3 across(const Vec3& normal, const Vec3& v) noexcept { return v - normal * normal.dot(v); }

Patch patch_of(std::span<const FrictionContact> contacts, double lever_m) noexcept {
  Patch patch;
  for (const FrictionContact& contact : contacts) {
    patch.force_m += contact.force_m;
    patch.centre += contact.force_m * contact.arm;
    patch.normal += contact.force_m * contact.normal;
  }
  const double length = patch.normal.norm();
  if (!(patch.force_m > 0.0 && length > 0.0))
    return {};
  patch.centre /= patch.force_m;
  patch.normal /= length;
  for (const FrictionContact& contact : contacts)
    patch.radius_m += contact.force_m * across(patch.normal, contact.arm - patch.centre).norm();
  patch.radius_m /= patch.force_m;
  if (!(patch.radius_m > kMinPatch * lever_m))
    patch.radius_m = 0.0;
  return patch;
}

/// How far the step that sticks goes along `m` from `from`; false where no such step keeps the
/// rows.
bool along_normal(std::span<const Halfspace> rows, const Vec6& from, const Vec3& m,
                  double requested, double& normal_step) noexcept {
  double least = -std::numeric_limits<double>::infinity(), most = -least;
  for (const Halfspace& row : rows) {
    const double opens = row.jacobian.head<3>().dot(m);
    const double lacks = row.least_m - row.jacobian.dot(from);
    if (std::abs(opens) < kAlongRowSine) {
      if (lacks > kKeptM)
        return false;
    } else if (opens > 0.0) {
      least = std::max(least, lacks / opens);
    } else {
      most = std::min(most, lacks / opens);
    }
  }
  if (least > most + kKeptM)
    return false;
  normal_step = std::max(least, std::min(requested, most));
  return true;
}

}  // namespace

FrictionStep with_friction(std::span<const FrictionContact> contacts,
                           std::span<const Halfspace> rows, const Vec6& spring, const Vec6& free,
                           double lever_m, double friction) noexcept {
  FrictionStep out{free, Mat6::Identity()};
  if (!(friction > 0.0))
    return out;
  const Patch patch = patch_of(contacts, lever_m);
  if (!(patch.force_m > 0.0))
    return out;
  const Vec3& m = patch.normal;
  const bool rotation_held = patch.radius_m > 0.0;
  const Vec3 rotation = rotation_held ? across(m, free.tail<3>()) : Vec3(free.tail<3>());
  Vec6 sticking;
  sticking << -across(m, (rotation / lever_m).cross(patch.centre)), rotation;
  const double requested = m.dot(spring.head<3>() - sticking.head<3>());
  double normal_step = 0.0;
  if (!along_normal(rows, sticking, m, requested, normal_step))
    return out;
  sticking.head<3>() += normal_step * m;

  const double force_sticking = std::max(0.0, normal_step - requested);
  const Vec6 unbalanced = spring - sticking;
  const double shift = across(m, unbalanced.head<3>()).norm();
  const double twist = rotation_held ? m.dot(unbalanced.tail<3>()) * lever_m / patch.radius_m : 0.0;
  const double needed = std::hypot(shift, twist), at_most = friction * force_sticking;
  if (needed <= at_most) {
    out.delta = sticking;
    Mat6 loose = Mat6::Identity();
    loose.topLeftCorner<3, 3>() = m * m.transpose();
    if (rotation_held)
      loose.bottomRightCorner<3, 3>() -= m * m.transpose();
    // Near the limit the friction fades: encoder steps would make a sliding tool alternately stick
    // and slip, and damping depends on the stiffness.
    const double slack = at_most > 0.0 ? 1.0 - needed / at_most : 0.0;
    out.loose -= smoothstep(0.0, kFirmSlack, slack) * (out.loose - loose);
    return out;
  }
  // needed (1 - slide) = friction (force_sticking + slide (patch.force_m - force_sticking))
  const double grows = needed + friction * (patch.force_m - force_sticking);
  const double slide = grows > 0.0 ? std::clamp((needed - at_most) / grows, 0.0, 1.0) : 1.0;
  out.delta = sticking + slide * (free - sticking);
  return out;
}

}  // namespace voxtouch::exact
