#pragma once
/// A triangle within one voxel: the common polygon, its area, and its point nearest to the voxel's
/// centre. All in grid units with the voxel's centre as origin, so that the voxel is the cube
/// [-1/2, 1/2]^3.
#include <array>

#include "core/types/geometry.hpp"

namespace voxtouch::pointshell {

/// Convex polygon: a triangle cut by six planes has at most nine corners.
struct VoxelPolygon {
  std::array<Vec3, 9> corner;
  int size = 0;
};

/// Triangle and cube, known to meet. Cuts without tolerance first; if rounding leaves nothing (they
/// only touch), with the least sufficient tolerance. Never empty.
VoxelPolygon clip_to_voxel(const Vec3& a, const Vec3& b, const Vec3& c) noexcept;

/// Area [e^2] that rounding can make of a polygon that has none.
inline constexpr double kTouchArea = 1e-14;

/// Area [voxel faces].
double area(const VoxelPolygon& polygon) noexcept;

/// The point of triangle and cube nearest to the origin; inside the cube. `normal`: the triangle's
/// unit normal, zero for a zero-area one. `polygon`: triangle and cube, from `clip_to_voxel`.
Vec3 nearest_to_centre(const std::array<Vec3, 3>& triangle, const Vec3& normal,
                       const VoxelPolygon& polygon) noexcept;

}  // namespace voxtouch::pointshell
