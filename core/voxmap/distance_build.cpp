#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/voxmap/brick_distances.hpp"
#include "core/voxmap/brick_range.hpp"
#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/winding.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr int kEdge = DistanceField::kBrickEdge;
/// From a brick's centre to its corners, with a margin for rounding.
constexpr double kBrickRadius = 4.0 * 1.7320509;

/// The kinds of a brick's voxels and of the preceding layer: all voxels around its own nodes.
class Kinds {
 public:
  Kinds(const Voxmap& voxmap, const VoxelIndex& first) {
    std::size_t n = 0;
    for (int z = -1; z < kEdge; ++z)
      for (int y = -1; y < kEdge; ++y)
        for (int x = -1; x < kEdge; ++x)
          kinds_[n++] = voxmap.at({first.i + x, first.j + y, first.k + z});
  }
  /// Classification by the eight voxels around a node: free = outside, interior = inside, surface =
  /// undecided.
  VoxelKind side(int x, int y, int z) const noexcept {
    for (int n = 0; n < 8; ++n) {
      const VoxelKind kind = kinds_[static_cast<std::size_t>(
          x + (n & 1) + kSide * (y + (n >> 1 & 1) + kSide * (z + (n >> 2))))];
      if (kind != VoxelKind::kSurface)
        return kind;
    }
    return VoxelKind::kSurface;
  }

 private:
  static constexpr int kSide = kEdge + 1;
  std::array<VoxelKind, kSide * kSide * kSide> kinds_;
};

}  // namespace

/// Fills a field brick by brick.
class DistanceFieldBuilder {
 public:
  DistanceFieldBuilder(const ClosedMesh& mesh, const Voxmap& voxmap,
                       const DistanceFieldOptions& options)
      : voxmap_(voxmap),
        mesh_(mesh.in_grid),
        shells_(mesh.shells),
        tree_(mesh.surface()),
        rays_(mesh.tree) {
    field_.grid_ = voxmap.grid(), field_.base_ = voxmap.base(), field_.cells_ = voxmap.cells();
    field_.depth_voxels_ = static_cast<float>(options.depth_voxels);  // in the precision of the
                                                                      // nodes
    field_.band_voxels_ = static_cast<float>(options.band_voxels);
    if (options.band_voxels > DistanceFieldOptions{}.band_voxels)
      widen(static_cast<int>(std::ceil(options.band_voxels / kEdge)));
  }

  DistanceField build(const ParallelFor& parallel_for, std::uint64_t memory_limit_bytes) {
    const std::size_t cells =
        static_cast<std::size_t>(field_.cells_[0] * field_.cells_[1] * field_.cells_[2]);
    field_.table_.assign(cells, DistanceField::kFree);
    if (shells_.closed_parts == 0)
      return std::move(field_);
    const auto layer = static_cast<std::size_t>(field_.cells_[0] * field_.cells_[1]);
    std::vector<std::vector<Requested>> of_layer(cells / layer);
    parallel_for(of_layer.size(), [&](std::size_t z) {
      std::uint32_t place = DistanceTree::kNoPlace;
      for (std::size_t cell = z * layer; cell < (z + 1) * layer; ++cell) {
        field_.table_[cell] = coarse(cell, place);
        if (field_.table_[cell] == kRequested)
          of_layer[z].push_back({cell, place});
      }
    });
    const std::vector<Requested> requested = list_requested(of_layer, memory_limit_bytes);
    fill(requested, parallel_for);
    return std::move(field_);
  }

 private:
  static constexpr std::int32_t kRequested = 0;
  /// A cell that gets a brick, and the place of a nearby triangle.
  struct Requested {
    std::size_t cell;
    std::uint32_t place;
  };

  /// The voxmap's table ends within one brick of the surface.
  void widen(int bricks) noexcept {
    for (std::int32_t* const first : {&field_.base_.i, &field_.base_.j, &field_.base_.k})
      *first -= kEdge * bricks;
    for (std::int64_t& cells : field_.cells_)
      cells += 2 * bricks;
  }

  VoxelIndex first_voxel(std::size_t cell) const noexcept {
    const auto c = static_cast<std::int64_t>(cell);
    const auto [nx, ny, nz] = field_.cells_;
    return {static_cast<std::int32_t>(field_.base_.i + kEdge * (c % nx)),
            static_cast<std::int32_t>(field_.base_.j + kEdge * (c / nx % ny)),
            static_cast<std::int32_t>(field_.base_.k + kEdge * (c / (nx * ny)))};
  }

  /// Whether a whole cell is beyond the range of the field, and on which side. `place`: as in
  /// DistanceTree::nearest.
  std::int32_t coarse(std::size_t cell, std::uint32_t& place) const {
    const VoxelIndex v = first_voxel(cell);
    const Vec3 centre(v.i + 4.0, v.j + 4.0, v.k + 4.0);
    const double outer = field_.band_voxels_ + kBrickRadius,
                 inner = field_.depth_voxels_ + kBrickRadius;
    if (voxmap_.free_distance_voxels(centre) > outer)
      return DistanceField::kFree;
    // No surface is that near, so the voxel at the centre gives the side of the whole cell.
    const VoxelKind kind = voxmap_.at({v.i + 4, v.j + 4, v.k + 4});
    if (kind == VoxelKind::kFree && tree_.nearest(centre, outer, place) >= outer)
      return DistanceField::kFree;
    if (kind == VoxelKind::kInterior && tree_.nearest(centre, inner, place) >= inner)
      return DistanceField::kDeep;
    return kRequested;
  }

  std::vector<Requested> list_requested(const std::vector<std::vector<Requested>>& of_layer,
                                        std::uint64_t memory_limit_bytes) {
    std::vector<Requested> requested;
    for (const std::vector<Requested>& layer : of_layer)
      requested.insert(requested.end(), layer.begin(), layer.end());
    field_.has_inside_ =
        std::ranges::find(field_.table_, DistanceField::kDeep) != field_.table_.end();
    for (std::size_t n = 0; n < requested.size(); ++n)
      field_.table_[requested[n].cell] = static_cast<std::int32_t>(n);
    const std::uint64_t bytes = requested.size() * sizeof(DistanceField::Brick);
    if (bytes > memory_limit_bytes)
      throw VoxelBudgetError("distance field: it needs up to " + std::to_string(bytes >> 20) +
                             " MiB, limit " + std::to_string(memory_limit_bytes >> 20) +
                             " MiB; use a larger voxel size, or a contact model without a field");
    return requested;
  }

  void fill(const std::vector<Requested>& requested, const ParallelFor& parallel_for) {
    field_.bricks_.resize(requested.size());
    std::vector<BrickRange> range(requested.size());
    parallel_for(requested.size(), [&](std::size_t n) {
      fill_own(first_voxel(requested[n].cell), requested[n].place, field_.bricks_[n]);
    });
    parallel_for(requested.size(), [&](std::size_t n) {
      fill_shared(requested[n].cell, field_.bricks_[n]);
      range[n] = range_of(field_.bricks_[n]);
    });
    std::size_t kept = 0;
    double largest = 1.0;
    for (std::size_t n = 0; n < requested.size(); ++n) {
      std::int32_t& entry = field_.table_[requested[n].cell];
      field_.has_inside_ = field_.has_inside_ || range[n].least < 0.0F;
      largest = std::max(largest, range[n].steepest_square);
      if (range[n].least >= field_.band_voxels_ || range[n].most <= -field_.depth_voxels_) {
        entry = range[n].least >= field_.band_voxels_ ? DistanceField::kFree : DistanceField::kDeep;
        continue;
      }
      entry = static_cast<std::int32_t>(kept);
      if (kept != n)
        field_.bricks_[kept] = field_.bricks_[n];
      ++kept;
    }
    field_.bricks_.resize(kept);
    field_.bricks_.shrink_to_fit();
    field_.steepest_gradient_ = std::sqrt(largest);
  }

  void fill_own(const VoxelIndex& first, std::uint32_t place, DistanceField::Brick& brick) const {
    const Kinds kinds(voxmap_, first);
    std::vector<std::uint32_t> above;
    BrickLimits limit;  // of each node; negative inside
    for (int z = 0; z < kEdge; ++z)
      for (int y = 0; y < kEdge; ++y)
        for (int x = 0; x < kEdge; ++x) {
          const VoxelKind side = kinds.side(x, y, z);
          const bool inside =
              side == VoxelKind::kSurface
                  ? inside_exactly(Vec3(first.i + x, first.j + y, first.k + z), above)
                  : side == VoxelKind::kInterior;
          limit[own_node(x, y, z)] = inside ? -field_.depth_voxels_ : field_.band_voxels_;
        }
    signed_distances(tree_, Vec3(first.i, first.j, first.k), limit, place, brick);
  }

  /// Copies the nodes that belong to the next bricks. A cell without a brick is cut off throughout,
  /// including its faces.
  void fill_shared(std::size_t cell, DistanceField::Brick& brick) {
    for (std::size_t next = 1; next < 8; ++next) {
      const std::array<int, 3> on = {static_cast<int>(next & 1), static_cast<int>(next >> 1 & 1),
                                     static_cast<int>(next >> 2)};
      const std::int32_t entry = neighbour_entry(cell, on);
      const DistanceField::Brick* const from =
          entry >= 0 ? &field_.bricks_[static_cast<std::size_t>(entry)] : nullptr;
      const auto cut_off = static_cast<float>(entry == DistanceField::kDeep ? -field_.depth_voxels_
                                                                            : field_.band_voxels_);
      // Along an axis to the next brick: its first node becomes the last here. Along the others:
      // all its own nodes.
      for (int z = 0; z < (on[2] ? 1 : kEdge); ++z)
        for (int y = 0; y < (on[1] ? 1 : kEdge); ++y)
          for (int x = 0; x < (on[0] ? 1 : kEdge); ++x)
            brick[node_of_brick(x + kEdge * on[0], y + kEdge * on[1], z + kEdge * on[2])] =
                from ? (*from)[node_of_brick(x, y, z)] : cut_off;
    }
  }

  /// Entry of the cell at this offset; all cells beyond the table are free.
  std::int32_t neighbour_entry(std::size_t cell, const std::array<int, 3>& on) const noexcept {
    const auto c = static_cast<std::int64_t>(cell);
    const auto [nx, ny, nz] = field_.cells_;
    const std::int64_t x = c % nx + on[0], y = c / nx % ny + on[1], z = c / (nx * ny) + on[2];
    return x < nx && y < ny && z < nz
               ? field_.table_[static_cast<std::size_t>(x + nx * (y + ny * z))]
               : DistanceField::kFree;
  }

  /// A node among surface voxels only. For a node on a triangle either result is possible; its
  /// distance is 0.
  bool inside_exactly(const Vec3& node, std::vector<std::uint32_t>& above) const {
    above.clear();
    rays_.each_on_ray(node, Vec3::UnitZ(),
                      [&](std::uint32_t triangle) { above.push_back(triangle); });
    return inside_shells(mesh_, shells_, above, node);
  }

  const Voxmap& voxmap_;
  const GridMesh& mesh_;
  const ClosedShells& shells_;
  const DistanceTree& tree_;  ///< of the surface
  const DistanceTree& rays_;  ///< of all triangles that a ray crosses
  DistanceField field_;
};

DistanceField build_distance_field(const ClosedMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes) {
  for (const double voxels : {options.depth_voxels, options.band_voxels})
    if (!(voxels >= 2.0 && voxels <= 1e4))
      throw std::invalid_argument(
          "distance field: depth and band are " + std::to_string(options.depth_voxels) + " and " +
          std::to_string(options.band_voxels) + " voxels; limits 2 to 10000");
  return DistanceFieldBuilder(mesh, voxmap, options).build(parallel_for, memory_limit_bytes);
}

DistanceField build_distance_field(const mesh::TriangleMesh& mesh, const Voxmap& voxmap,
                                   const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for,
                                   std::uint64_t memory_limit_bytes) {
  return build_distance_field(ClosedMesh(mesh, voxmap.grid()), voxmap, options, parallel_for,
                              memory_limit_bytes);
}

}  // namespace voxtouch::voxmap
