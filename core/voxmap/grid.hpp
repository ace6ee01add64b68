#pragma once
/// The voxel grid: position of voxel (i, j, k), and the only function that assigns a point to a
/// voxel.
#include <cmath>
#include <compare>
#include <cstdint>

#include "core/types/geometry.hpp"

namespace voxtouch::voxmap {

/// Integer address of a voxel; negative values are allowed.
struct VoxelIndex {
  std::int32_t i = 0, j = 0, k = 0;
  auto operator<=>(const VoxelIndex&) const = default;
};

/// Voxel (i,j,k) is the closed cube origin + edge * [i,i+1] x [j,j+1] x [k,k+1].
struct Grid {
  Vec3 origin = Vec3::Zero();  ///< [m], W for a voxmap, T for a pointshell
  double edge = 1.0;           ///< voxel edge e [m]

  /// Grid coordinates u = (x - origin) / e. Every decision on the grid is exact in u.
  Vec3 to_grid(const Vec3& x) const noexcept { return (x - origin) / edge; }
  /// The point with these grid coordinates [m], in the grid's frame.
  Vec3 from_grid(const Vec3& u) const noexcept { return origin + edge * u; }
  /// Centre of the voxel [m], in the grid's frame.
  Vec3 centre(const VoxelIndex& v) const noexcept {
    return from_grid(Vec3(v.i + 0.5, v.j + 0.5, v.k + 0.5));
  }
  /// Half-open: floor(u). `u` must lie within the int32 range.
  static VoxelIndex voxel_of(const Vec3& u) noexcept {
    return {static_cast<std::int32_t>(std::floor(u.x())),
            static_cast<std::int32_t>(std::floor(u.y())),
            static_cast<std::int32_t>(std::floor(u.z()))};
  }
};

}  // namespace voxtouch::voxmap
