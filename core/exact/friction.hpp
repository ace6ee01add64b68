#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/exact/projection.hpp"

namespace voxtouch::exact {

/// An active row and what it pushes with.
struct FrictionContact {
  Vec3 normal = Vec3::Zero();  ///< unit, W, from the object to the tool
  Vec3 arm = Vec3::Zero();     ///< from the tool's origin, W [m]
  double force_m = 0.0;        ///< over the spring's stiffness
};

struct FrictionStep {
  Vec6 delta = Vec6::Zero();
  /// What friction does not hold: a projector, which fades to all where friction is near its limit.
  Mat6 loose = Mat6::Identity();
};

/// The part of the step `free` that friction lets happen; `contacts` are its active rows, `rows`
/// all of them.
///
/// The contact slips by the shift of its centre of force across the mean normal m, and by radius
/// times the rotation about m; friction holds both together (an ellipsoid as limit surface: Howe
/// and Cutkosky 1996). Two steps are compared: `free`, and one that does not slip, in which the
/// tool goes along m only and turns across it as it does in `free`. Where the friction f that the
/// second needs is at most mu N, the tool sticks: the tool itself is the anchor, and nothing
/// creeps. Else the step lies between both, as far from sticking as leaves mu N. Both keep the
/// rows, and so does what lies between; where no step sticks, `free` stays. N is the sum of all
/// forces. Real-time safe.
FrictionStep with_friction(std::span<const FrictionContact> contacts,
                           std::span<const Halfspace> rows, const Vec6& spring, const Vec6& free,
                           double lever_m, double friction) noexcept;

}  // namespace voxtouch::exact
