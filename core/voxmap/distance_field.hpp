#pragma once
/// Signed distance to the static surface, interpolated within voxels, for the contact model
/// `field`.
///
/// Nodes are at the corners of the voxels. The interpolated distance is thus positive in every free
/// voxel and negative in every interior one. A shell point in a free voxel, which no query reports,
/// never has a depth.
///
/// Magnitude: exact distance to the triangles of the mesh's closed parts, stored as float32 in
/// voxels (2^-24 of at most 12 voxels is below 1e-6 e).
///
/// Sign: from the voxmap. A node next to a free voxel is outside, one next to an interior voxel
/// inside. Between eight surface voxels the exact winding number decides (winding.hpp). The planes
/// of triangles are not used, so an inverted facet gives no wrong sign.
///
/// Open parts have no interior. They give no distance and no force. Overlapping closed parts form
/// one body; surfaces inside it limit the depth there.
///
/// Layout: bricks of 8^3 voxels with their 9^3 nodes (2916 bytes), so that a lookup reads one
/// brick. Nodes on common faces are bit-identical, so the interpolation is continuous. Distances
/// are cut off at `band_voxels` outside and `depth_voxels` inside; bricks of cut-off values only
/// are not stored.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"
#include "core/types/huge_pages.hpp"
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::voxmap {

struct ClosedMesh;

/// Sample of the field at one point.
struct FieldSample {
  double distance_m = 0.0;  ///< interpolated signed distance [m], negative inside
  /// Of the interpolation, W axes; about unit length, pointing out of the static object.
  Vec3 gradient = Vec3::Zero();
  bool known =
      false;  ///< false: outside the range of the field; `distance_m` is that of its border
  bool saturated =
      false;  ///< inside, deeper than the field stores: `distance_m` does not grow further
};

/// Range of the stored distances.
struct DistanceFieldOptions {
  double depth_voxels = 12.0;  ///< largest depth stored inside; at least 2
  /// Range outside; at least 2, more than a voxel's diagonal. A band above 2 extends the table
  /// beyond the voxmap's, so that it is complete on every side.
  double band_voxels = 2.0;
};

class DistanceField {
 public:
  static constexpr int kBrickEdge = Voxmap::kBrickEdge;  ///< voxels
  static constexpr int kNodeEdge = kBrickEdge + 1;       ///< nodes
  using Brick = std::array<float, kNodeEdge * kNodeEdge *
                                      kNodeEdge>;  ///< [voxels]; node (x,y,z) at x + 9 (y + 9 z)

  /// Sample at the grid coordinates u = (x - origin) / e of the voxmap's grid. Continuous in u.
  /// Non-finite coordinates give an unknown sample. Real-time safe.
  FieldSample at(const Vec3& u) const noexcept;

  /// The stored distance [voxels] of the node at the lower corner of `voxel`, cut off at the band
  /// outside and the depth inside; the band if no node is stored. Real-time safe.
  double node(const VoxelIndex& voxel) const noexcept;

  /// The data of `at`, for loops over many points: the brick of a table cell, or kFree or kDeep
  /// without one.
  struct Arrays {
    const std::int32_t* table;
    const Brick* bricks;
    std::array<std::int32_t, 3> base;
    std::array<std::int64_t, 3> cells;
    double depth_voxels, band_voxels;
  };
  Arrays arrays() const noexcept {
    return {table_.data(), bricks_.data(), {base_.i, base_.j, base_.k},
            cells_,        depth_voxels_,  band_voxels_};
  }
  static constexpr std::int32_t kFree = -1, kDeep = -2;

  const Grid& grid() const noexcept { return grid_; }
  /// Memory of all stored data.
  std::size_t bytes() const noexcept;
  /// Number of stored nodes; those on common faces count once for each brick.
  std::size_t stored_nodes() const noexcept { return bricks_.size() * Brick().size(); }
  /// Whether any node is inside. False for an open mesh, and for one so thin that no
  /// voxel corner lies in it.
  bool has_inside() const noexcept { return has_inside_; }
  /// Depth at which the distance stops growing [m].
  double depth_m() const noexcept { return grid_.edge * depth_voxels_; }
  /// Bound of the gradient's length where the interpolated distance is negative: 1 at flat walls,
  /// up to sqrt(2) in a concave edge and sqrt(3) in a concave corner.
  double steepest_gradient() const noexcept { return steepest_gradient_; }

 private:
  friend class DistanceFieldBuilder;

  /// The table's entry, or kFree outside the table.
  std::int32_t entry_at(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;

  Grid grid_;
  VoxelIndex base_;                      ///< first voxel of the table, a multiple of 8
  std::array<std::int64_t, 3> cells_{};  ///< table size in bricks
  std::vector<std::int32_t> table_;
  std::vector<Brick, HugePages<Brick>> bricks_;
  double depth_voxels_ = 0.0, band_voxels_ = 0.0;
  bool has_inside_ = false;
  double steepest_gradient_ = 1.0;
};

/// Builds the field of the mesh of `voxmap`; concatenate several static meshes. Bit-identical for
/// any `parallel_for`. Throws std::invalid_argument for options out of range. Throws
/// VoxelBudgetError, without any allocation, if the bricks would exceed `memory_limit_bytes`. The
/// overload for a mesh creates the ClosedMesh itself.
DistanceField build_distance_field(const ClosedMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);
DistanceField build_distance_field(const mesh::TriangleMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);

}  // namespace voxtouch::voxmap
