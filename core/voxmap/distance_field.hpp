#pragma once
/// Signed distance to the static surface, interpolated below one voxel: what the contact model
/// `field` looks up.
///
/// Nodes stand at the corners of the voxels, so the interpolated distance is above 0 in every free
/// voxel and below 0 in every interior one: a shell point in a free voxel, which no query reports,
/// never has a depth.
///
/// Magnitude: exact distance to the triangles of the mesh's closed parts, stored as float32 in
/// voxels (2^-24 of at most 12 voxels is below 1e-6 e). Sign: from the voxmap. A node with a free
/// voxel round it is outside, one with an interior voxel inside; between eight surface voxels the
/// exact winding number decides (winding.hpp). Planes of triangles have no part in it, so an
/// inverted facet gives no wrong sign.
///
/// Open parts have no inside: they give no distance and no force, unless the options make thin
/// walls of them. The distance to such a wall is the unsigned one less half its thickness. Closed
/// parts and walls that overlap are one body; surfaces buried in it limit the depth there.
///
/// Layout: bricks of 8^3 voxels with their 9^3 nodes (2916 bytes), so that a lookup meets one
/// brick. Nodes on common faces are bit-identical, so the interpolation is continuous. Distances
/// are cut off at `band_voxels` outside and `depth_voxels` inside; bricks of cut-off values alone
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
struct SmoothBlock;

/// What the field says about one point.
struct FieldSample {
  double distance_m = 0.0;       ///< interpolated signed distance [m], negative inside
  Vec3 gradient = Vec3::Zero();  ///< of the interpolation, W axes; about unit length, pointing out
                                 ///< of the static object
  bool known =
      false;  ///< false: farther outside than the field holds; `distance_m` is that border's
  bool saturated =
      false;  ///< inside, deeper than the field holds: `distance_m` does not grow further
};

/// How much of the field is stored.
struct DistanceFieldOptions {
  double depth_voxels = 12.0;  ///< inside, distances are held down to this depth; at least 2
  /// Outside, up to here; at least 2, more than a voxel's diagonal. A band above 2 widens the table
  /// beyond the voxmap's, so that it is held on every side.
  double band_voxels = 2.0;
  /// Thickness of the walls that open parts become, half of it on either side of their triangles;
  /// 0: none, they give no distance.
  double open_wall_voxels = 0.0;
};
/// How thick they are for a virtual tool, which they hold from either side; force begins half of
/// that early.
inline constexpr double kOpenWallVoxels = 0.125;

class DistanceField {
 public:
  static constexpr int kBrickEdge = Voxmap::kBrickEdge;  ///< voxels
  static constexpr int kNodeEdge = kBrickEdge + 1;       ///< nodes
  using Brick = std::array<float, kNodeEdge * kNodeEdge *
                                      kNodeEdge>;  ///< [voxels]; node (x,y,z) at x + 9 (y + 9 z)

  /// Sample at the grid coordinates u = (x - origin) / e of the voxmap's grid. Continuous in u.
  /// Anything not finite is unknown. Real-time safe.
  FieldSample at(const Vec3& u) const noexcept;

  static constexpr std::size_t kSmoothTogether =
      8;  ///< the most places that `smooth_gradients` takes
  /// Gradients at `count` places `u` (grid coordinates, finite, within int32), W axes, that do not
  /// jump from voxel to voxel: differences over two voxels at the corners of the point's voxel,
  /// interpolated. Exact for polynomials of second degree. A distance that is cut off outside is
  /// extrapolated from the nodes before it. Bit-identical for a place whatever else is looked up,
  /// on every processor. Real-time safe.
  void smooth_gradients(std::size_t count, const Vec3* u, Vec3* gradients) const noexcept;
  /// Of one place.
  Vec3 smooth_gradient(const Vec3& u) const noexcept {
    Vec3 gradient;
    smooth_gradients(1, &u, &gradient);
    return gradient;
  }

  /// The stored distance [voxels] of the node at the lower corner of `voxel`, cut off at the band
  /// outside and the depth inside; the band where nothing is stored. Real-time safe.
  double node(const VoxelIndex& voxel) const noexcept;

  /// What `at` looks up, for loops over many points: the brick of a cell of the table, or kFree or
  /// kDeep where it has none.
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
  /// Memory of all that is stored.
  std::size_t bytes() const noexcept;
  /// Nodes in memory, those on common faces once for each brick.
  std::size_t stored_nodes() const noexcept { return bricks_.size() * Brick().size(); }
  /// Whether any node is inside. An open mesh of which no wall is made has none; neither has one so
  /// thin that no voxel's corner lies in it.
  bool has_inside() const noexcept { return has_inside_; }
  /// Depth at which the field stops to grow [m].
  double depth_m() const noexcept { return grid_.edge * depth_voxels_; }
  /// Bound of the gradient's length wherever the interpolated distance is below 0: 1 over flat
  /// walls, up to sqrt(2) in a concave edge and sqrt(3) in a concave corner.
  double steepest_gradient() const noexcept { return steepest_gradient_; }

 private:
  friend class DistanceFieldBuilder;

  /// The table's entry, or kFree beyond the table.
  std::int32_t entry_at(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;
  struct Nodes;
  Nodes nodes_of(const std::array<std::int64_t, 3>& cell) const noexcept;
  void put_smooth(const Vec3& u, std::size_t lane, SmoothBlock& block) const noexcept;

  Grid grid_;
  VoxelIndex base_;                      ///< first voxel of the table, a multiple of 8
  std::array<std::int64_t, 3> cells_{};  ///< table size in bricks
  std::vector<std::int32_t> table_;
  std::vector<Brick, HugePages<Brick>> bricks_;
  double depth_voxels_ = 0.0, band_voxels_ = 0.0;
  bool has_inside_ = false;
  double steepest_gradient_ = 1.0;
};

/// The field of the mesh that `voxmap` was made from. Several static meshes: concatenate them.
/// Bit-identical whatever `parallel_for` does. Throws std::invalid_argument for options out of
/// range and VoxelBudgetError where the bricks would take more than `memory_limit_bytes`, before
/// they are allocated. Of a mesh alone it makes the ClosedMesh itself.
DistanceField build_distance_field(const ClosedMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);
DistanceField build_distance_field(const mesh::TriangleMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);

}  // namespace voxtouch::voxmap
