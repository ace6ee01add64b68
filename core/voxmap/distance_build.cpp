#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/voxmap/brick_distances.hpp"
#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/distance_field.hpp"
#include "core/voxmap/winding.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr int kEdge = DistanceField::kBrickEdge, kNodes = DistanceField::kNodeEdge;
/// From a brick's centre to its corners, and a little for rounding.
constexpr double kBrickRadius = 4.0 * 1.7320509;

/// The kinds of a brick's voxels and of the layer round it.
class Kinds {
 public:
  Kinds(const Voxmap& voxmap, const VoxelIndex& first) {
    std::size_t n = 0;
    for (int z = -1; z <= kEdge; ++z)
      for (int y = -1; y <= kEdge; ++y)
        for (int x = -1; x <= kEdge; ++x) kinds_[n++] = voxmap.at({first.i + x, first.j + y, first.k + z});
  }
  /// What the eight voxels round a node say: free = outside, interior = inside, surface = undecided.
  VoxelKind side(int x, int y, int z) const noexcept {
    for (int n = 0; n < 8; ++n) {
      const VoxelKind kind =
          kinds_[static_cast<std::size_t>(x + (n & 1) + kSide * (y + (n >> 1 & 1) + kSide * (z + (n >> 2))))];
      if (kind != VoxelKind::kSurface) return kind;
    }
    return VoxelKind::kSurface;
  }

 private:
  static constexpr int kSide = kEdge + 2;
  std::array<VoxelKind, kSide * kSide * kSide> kinds_;
};

/// Eight values at the corners of a box, and what the interpolation between them does.
using Corners = std::array<double, 8>;  // corner (x, y, z) at x + 2 y + 4 z

double interpolated(const Corners& d, const Vec3& t) noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < 8; ++n)
    sum += d[n] * (n & 1 ? t.x() : 1.0 - t.x()) * (n & 2 ? t.y() : 1.0 - t.y()) * (n & 4 ? t.z() : 1.0 - t.z());
  return sum;
}

/// Largest square of the gradient in a box of side `side`. Each component is linear along each axis, so its square is convex
/// along each, and the sum is largest at one of the eight corners.
double steepest_square(const Corners& d, double side) noexcept {
  double steepest = 0.0;
  for (std::size_t n = 0; n < 8; ++n) {
    const Vec3 differences(d[n | 1] - d[n & ~std::size_t{1}], d[n | 2] - d[n & ~std::size_t{2}],
                           d[n | 4] - d[n & ~std::size_t{4}]);
    steepest = std::max(steepest, differences.squaredNorm());
  }
  return steepest / (side * side);
}

/// The same where the interpolation is below 0, to an eighth of the voxel, or `best` if that is more: outside a convex edge
/// distances fan out, which is steep and pushes nothing.
double steepest_square_inside(const Corners& d, double side, int splits, double best) noexcept {
  const auto [least, most] = std::minmax_element(d.begin(), d.end());
  if (*least >= 0.0) return best;
  const double whole = steepest_square(d, side);
  if (whole <= best) return best;
  if (splits == 0 || *most < 0.0) return whole;
  for (int part = 0; part < 8; ++part) {
    const Vec3 low = Vec3(part & 1, part >> 1 & 1, part >> 2) / 2.0;
    Corners octant{};
    for (int n = 0; n < 8; ++n)
      octant[static_cast<std::size_t>(n)] = interpolated(d, low + Vec3(n & 1, n >> 1 & 1, n >> 2) / 2.0);
    best = steepest_square_inside(octant, side / 2.0, splits - 1, best);
  }
  return best;
}

}  // namespace

/// Fills a field brick by brick.
class DistanceFieldBuilder {
 public:
  DistanceFieldBuilder(const ClosedMesh& mesh, const Voxmap& voxmap, const DistanceFieldOptions& options)
      : voxmap_(voxmap), mesh_(mesh.in_grid), shells_(mesh.shells), tree_(mesh.tree) {
    field_.grid_ = voxmap.grid(), field_.base_ = voxmap.base(), field_.cells_ = voxmap.cells();
    field_.depth_voxels_ = static_cast<float>(options.depth_voxels);  // as the nodes hold it
    field_.band_voxels_ = static_cast<float>(options.band_voxels);
    if (options.band_voxels > DistanceFieldOptions{}.band_voxels) widen(static_cast<int>(std::ceil(options.band_voxels / kEdge)));
  }

  DistanceField build(const ParallelFor& parallel_for, std::uint64_t memory_limit_bytes) {
    const std::size_t cells = static_cast<std::size_t>(field_.cells_[0] * field_.cells_[1] * field_.cells_[2]);
    field_.table_.assign(cells, DistanceField::kFree);
    if (shells_.closed_parts == 0) return std::move(field_);
    std::vector<std::int32_t> side(cells, DistanceField::kFree);  // of cells without a brick; kWanted: has one
    const auto layer = static_cast<std::size_t>(field_.cells_[0] * field_.cells_[1]);
    parallel_for(cells / layer, [&](std::size_t z) {
      for (std::size_t cell = z * layer; cell < (z + 1) * layer; ++cell) side[cell] = coarse(cell);
    });
    const std::vector<std::size_t> wanted = list_wanted(side, memory_limit_bytes);
    fill(wanted, parallel_for);
    return std::move(field_);
  }

 private:
  static constexpr std::int32_t kWanted = 0;

  /// The voxmap's table ends within a brick of the surface.
  void widen(int bricks) noexcept {
    for (std::int32_t* const first : {&field_.base_.i, &field_.base_.j, &field_.base_.k}) *first -= kEdge * bricks;
    for (std::int64_t& cells : field_.cells_) cells += 2 * bricks;
  }

  VoxelIndex first_voxel(std::size_t cell) const noexcept {
    const auto c = static_cast<std::int64_t>(cell);
    const auto [nx, ny, nz] = field_.cells_;
    return {static_cast<std::int32_t>(field_.base_.i + kEdge * (c % nx)),
            static_cast<std::int32_t>(field_.base_.j + kEdge * (c / nx % ny)),
            static_cast<std::int32_t>(field_.base_.k + kEdge * (c / (nx * ny)))};
  }

  /// Whether all of a cell is beyond what the field holds, and on which side.
  std::int32_t coarse(std::size_t cell) const {
    const VoxelIndex v = first_voxel(cell);
    const Vec3 centre(v.i + 4.0, v.j + 4.0, v.k + 4.0);
    const double outer = field_.band_voxels_ + kBrickRadius, inner = field_.depth_voxels_ + kBrickRadius;
    if (voxmap_.free_distance_voxels(centre) > outer) return DistanceField::kFree;
    // No surface that near, so the centre's own voxel tells the side of the whole cell.
    const VoxelKind kind = voxmap_.at({v.i + 4, v.j + 4, v.k + 4});
    if (kind == VoxelKind::kFree && tree_.nearest(centre, outer) >= outer) return DistanceField::kFree;
    if (kind == VoxelKind::kInterior && tree_.nearest(centre, inner) >= inner) return DistanceField::kDeep;
    return kWanted;
  }

  std::vector<std::size_t> list_wanted(const std::vector<std::int32_t>& side, std::uint64_t memory_limit_bytes) {
    std::vector<std::size_t> wanted;
    for (std::size_t cell = 0; cell < side.size(); ++cell) {
      if (side[cell] == kWanted)
        wanted.push_back(cell);
      else
        field_.table_[cell] = side[cell];
      field_.has_inside_ = field_.has_inside_ || side[cell] == DistanceField::kDeep;
    }
    const std::uint64_t bytes = wanted.size() * sizeof(DistanceField::Brick);
    if (bytes > memory_limit_bytes)
      throw VoxelBudgetError("distance field: it would take up to " + std::to_string(bytes >> 20) +
                             " MiB, more than the limit of " + std::to_string(memory_limit_bytes >> 20) +
                             " MiB; use a larger voxel size, or a contact model that needs no field");
    return wanted;
  }

  void fill(const std::vector<std::size_t>& wanted, const ParallelFor& parallel_for) {
    field_.bricks_.resize(wanted.size());
    std::vector<double> steepest(wanted.size(), 0.0);
    parallel_for(wanted.size(), [&](std::size_t n) {
      fill_brick(first_voxel(wanted[n]), field_.bricks_[n]);
      steepest[n] = steepest_in(field_.bricks_[n]);
    });
    std::size_t kept = 0;
    double largest = 1.0;
    for (std::size_t n = 0; n < wanted.size(); ++n) {
      const auto [least, most] = std::minmax_element(field_.bricks_[n].begin(), field_.bricks_[n].end());
      field_.has_inside_ = field_.has_inside_ || *least < 0.0F;
      largest = std::max(largest, steepest[n]);
      if (*least >= field_.band_voxels_) continue;
      if (*most <= -field_.depth_voxels_) {
        field_.table_[wanted[n]] = DistanceField::kDeep;
        continue;
      }
      field_.table_[wanted[n]] = static_cast<std::int32_t>(kept);
      if (kept != n) field_.bricks_[kept] = field_.bricks_[n];
      ++kept;
    }
    field_.bricks_.resize(kept);
    field_.bricks_.shrink_to_fit();
    field_.steepest_gradient_ = std::sqrt(largest);
  }

  void fill_brick(const VoxelIndex& first, DistanceField::Brick& brick) const {
    const Kinds kinds(voxmap_, first);
    std::vector<std::uint32_t> above;
    BrickLimits limit;  // of each node; below 0 inside
    for (int z = 0; z < kNodes; ++z)
      for (int y = 0; y < kNodes; ++y)
        for (int x = 0; x < kNodes; ++x) {
          const VoxelKind side = kinds.side(x, y, z);
          const bool inside = side == VoxelKind::kSurface ? inside_exactly(Vec3(first.i + x, first.j + y, first.k + z), above)
                                                          : side == VoxelKind::kInterior;
          limit[node_of_brick(x, y, z)] = inside ? -field_.depth_voxels_ : field_.band_voxels_;
        }
    signed_distances(tree_, Vec3(first.i, first.j, first.k), limit, brick);
  }

  /// A node among surface voxels only. One on a triangle may come out either way; its distance is 0.
  bool inside_exactly(const Vec3& node, std::vector<std::uint32_t>& above) const {
    above.clear();
    tree_.each_on_ray(node, Vec3::UnitZ(), [&](std::uint32_t triangle) { above.push_back(triangle); });
    return inside_shells(mesh_, shells_, above, node);
  }

  static double steepest_in(const DistanceField::Brick& brick) noexcept {
    double steepest = 1.0;
    for (int z = 0; z < kEdge; ++z)
      for (int y = 0; y < kEdge; ++y)
        for (int x = 0; x < kEdge; ++x) {
          const float* const d = &brick[node_of_brick(x, y, z)];
          Corners voxel{};
          for (int n = 0; n < 8; ++n) voxel[static_cast<std::size_t>(n)] = d[node_of_brick(n & 1, n >> 1 & 1, n >> 2)];
          steepest = steepest_square_inside(voxel, 1.0, 3, steepest);
        }
    return steepest;
  }

  const Voxmap& voxmap_;
  const GridMesh& mesh_;
  const ClosedShells& shells_;
  const DistanceTree& tree_;
  DistanceField field_;
};

DistanceField build_distance_field(const ClosedMesh& mesh, const Voxmap& voxmap, const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for, std::uint64_t memory_limit_bytes) {
  for (const double voxels : {options.depth_voxels, options.band_voxels})
    if (!(voxels >= 2.0 && voxels <= 1e4))
      throw std::invalid_argument("distance field: depth and band are " + std::to_string(options.depth_voxels) +
                                  " and " + std::to_string(options.band_voxels) +
                                  " voxels; each must lie between 2 and 10000");
  return DistanceFieldBuilder(mesh, voxmap, options).build(parallel_for, memory_limit_bytes);
}

DistanceField build_distance_field(const mesh::TriangleMesh& mesh, const Voxmap& voxmap, const DistanceFieldOptions& options,
                                   const ParallelFor& parallel_for, std::uint64_t memory_limit_bytes) {
  return build_distance_field(ClosedMesh(mesh, voxmap.grid()), voxmap, options, parallel_for, memory_limit_bytes);
}

}  // namespace voxtouch::voxmap
