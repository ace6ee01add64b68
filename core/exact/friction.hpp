#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/exact/projection.hpp"

namespace voxtouch::exact {

/// An active row and its contact force.
struct FrictionContact {
  Vec3 normal = Vec3::Zero();  ///< unit, W, from the object to the tool
  Vec3 arm = Vec3::Zero();     ///< from the tool's origin, W [m]
  double force_m = 0.0;        ///< over the spring's stiffness
};

struct FrictionStep {
  Vec6 delta = Vec6::Zero();
  /// Projector on the motions that friction does not prevent; fades to identity near its limit.
  Mat6 loose = Mat6::Identity();
};

/// The part of the step `free` that friction allows; `contacts` are its active rows, `rows` all
/// rows.
///
/// Slip is the displacement of the centre of force across the mean normal m, and radius times the
/// rotation about m. One limit holds for both together (an ellipsoid as limit surface: Howe and
/// Cutkosky 1996). A second step has no slip: the tool moves along m only and rotates across it as
/// in `free`. With N the sum of all forces, the tool sticks if that step needs friction of at most
/// mu N. The tool's pose is then the anchor, so it does not creep. Otherwise the result is the step
/// between both at which friction is mu N. It satisfies the rows, since both do. If there is no
/// second step, the result is `free`. Real-time safe.
FrictionStep with_friction(std::span<const FrictionContact> contacts,
                           std::span<const Halfspace> rows, const Vec6& spring, const Vec6& free,
                           double lever_m, double friction) noexcept;

}  // namespace voxtouch::exact
