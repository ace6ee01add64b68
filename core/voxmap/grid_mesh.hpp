#pragma once
/// A mesh in grid coordinates, and the memory estimate of its voxels, computed without allocation.
#include <array>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::voxmap {

/// The voxels of a mesh would exceed the memory limit, or the int32 range of indices. The sentence
/// names extent, voxel size and memory.
class VoxelBudgetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Size of a voxel grid around a mesh, computed from the vertices alone without allocation.
struct VoxelEstimate {
  std::array<double, 3> first{}, last{};  ///< voxel box, inclusive; integers, possibly beyond int32
  double extent_m = 0.0;                  ///< longest side of the mesh's box [m]
  double voxels = 0.0;                    ///< voxels in the box
  double surface_voxels = 0.0;            ///< expected number
  double table_cells = 0.0;               ///< entries of the voxmap's table, one per brick of 8x8x8
  /// Of the finished voxmap: exact for the table, expected for distances and bricks.
  double bytes = 0.0;
  double build_bytes = 0.0;  ///< peak while it is built
};

inline constexpr std::uint64_t kVoxelMemoryLimit = std::uint64_t{4} << 30;  ///< 4 GiB
/// Voxel indices stay within +-2^30, so that borders and differences fit int32.
inline constexpr double kMaxVoxelIndex = 1073741824.0;

/// Grid with borders at multiples of e: e * (floor(min / e) - 1) on each axis over the used
/// vertices, with one layer of free voxels in front. Used for pointshells; static objects have
/// `object_grid`. Throws std::runtime_error for no triangles, a vertex that is not finite, an
/// invalid index, or an edge that is not a positive number.
Grid default_grid(const mesh::TriangleMesh& mesh, double edge);

/// Throws std::runtime_error like `default_grid`; otherwise never refuses.
VoxelEstimate estimate_voxels(const mesh::TriangleMesh& mesh, const Grid& grid);
/// Throws VoxelBudgetError if the estimate exceeds `limit_bytes`, the int32 range, or the table of
/// a voxmap.
void require_affordable(const VoxelEstimate& estimate, const Grid& grid,
                        std::uint64_t limit_bytes = kVoxelMemoryLimit);

/// Vertices in grid coordinates u = (x - origin) / e, computed once: every later decision is exact
/// in these doubles. A |u| below 2^-300 counts as 0, so that no product of three coordinates
/// underflows.
struct GridMesh {
  std::vector<Vec3> u;
  /// Those of the mesh, which must outlive this object.
  const std::vector<std::array<std::uint32_t, 3>>* triangles = nullptr;

  GridMesh(const mesh::TriangleMesh& mesh, const Grid& grid);
  std::size_t size() const noexcept { return triangles->size(); }
  const Vec3& corner(std::size_t triangle, int k) const noexcept {
    return u[(*triangles)[triangle][static_cast<std::size_t>(k)]];
  }
};

}  // namespace voxtouch::voxmap
