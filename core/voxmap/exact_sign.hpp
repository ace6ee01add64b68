#pragma once
/// Exact signs of determinants: the side of a line or plane on which a point lies, decided exactly
/// for the given doubles.
///
/// A floating-point filter decides nearly all cases; the others are computed with expansions (sums
/// of nonoverlapping doubles; Shewchuk, "Adaptive precision floating-point arithmetic and fast
/// robust geometric predicates", 1997). Exact if every coordinate is 0 or has a magnitude in
/// [2^-300, 2^300]; `GridMesh` ensures it.
#include "core/types/geometry.hpp"

namespace voxtouch::voxmap {

/// (b - a) x (p - a) in the plane: > 0 if p is left of the line a->b. Exact sign.
double orient2d(double ax, double ay, double bx, double by, double px, double py) noexcept;

/// ((b - a) x (c - a)) . (p - a): > 0 if p is on the side of the triangle's normal. Exact sign.
double orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) noexcept;

/// Twice the area vector of the triangle, each component with exact sign and a relative error below
/// 2^-37: zero only if the area is zero.
Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

}  // namespace voxtouch::voxmap
