#pragma once
/// Signs of determinants without rounding: on which side of a line or plane a point lies, decided
/// exactly for the doubles given.
///
/// A floating-point filter answers nearly always; what it cannot decide is worked out with
/// expansions (sums of doubles that do not overlap; Shewchuk, "Adaptive precision floating-point
/// arithmetic and fast robust geometric predicates", 1997). Exact while every coordinate is 0 or
/// has a magnitude in [2^-300, 2^300]: `GridMesh` sees to that.
#include "core/types/geometry.hpp"

namespace voxtouch::voxmap {

/// (b - a) x (p - a) in the plane: > 0 where p lies left of the line a->b. Exact sign.
double orient2d(double ax, double ay, double bx, double by, double px, double py) noexcept;

/// ((b - a) x (c - a)) . (p - a): > 0 where p lies on the side to which the triangle's normal
/// points. Exact sign.
double orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) noexcept;

/// Twice the triangle's area vector, each component with exact sign and a relative error below
/// 2^-37: zero only if the area is zero.
Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

}  // namespace voxtouch::voxmap
