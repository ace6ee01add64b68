#include "core/voxmap/voxelise.hpp"

#include <algorithm>

#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/slabs.hpp"
#include "core/voxmap/solid_surface.hpp"
#include "core/voxmap/triangle_voxels.hpp"
#include "core/voxmap/voxel_groups.hpp"
#include "core/voxmap/winding.hpp"

namespace voxtouch::voxmap {
namespace {

// finished, marked, two pieces, spare
constexpr double kBuildBytesPerBrick = sizeof(Voxmap::Brick) + 4.0 * sizeof(BrickMask);

/// The bricks of one slab: cells along y and z, allocated at the first mark.
struct SlabBits {
  std::vector<std::int32_t> brick_of;
  std::vector<BrickMask> bricks;
};

SlabBits mark_slab(const GridMesh& mesh, const Slabs& slabs, std::size_t slab,
                   const VoxelIndex& base, const std::array<std::int64_t, 3>& cells) {
  SlabBits bits;
  bits.brick_of.assign(static_cast<std::size_t>(cells[1] * cells[2]), -1);
  std::int64_t cached = -1;
  BrickMask* brick = nullptr;
  const auto mark = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::int64_t y = std::int64_t{j} - base.j, z = std::int64_t{k} - base.k;
    const std::int64_t cell = (y >> 3) * cells[2] + (z >> 3);
    if (cell != cached) {
      std::int32_t& entry = bits.brick_of[static_cast<std::size_t>(cell)];
      if (entry < 0) {
        entry = static_cast<std::int32_t>(bits.bricks.size());
        bits.bricks.emplace_back();
      }
      brick = &bits.bricks[static_cast<std::size_t>(entry)];
      cached = cell;
    }
    (*brick)[static_cast<std::size_t>(z & 7)] |= std::uint64_t{1}
                                                 << ((i - slabs.first(slab)) + 8 * (y & 7));
  };
  for (const std::uint32_t t : slabs.triangles(slab)) {
    const TriangleVoxels triangle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2));
    const bool along_k = triangle.run_axis() == 2;
    triangle.for_each_run(
        slabs.first(slab), slabs.last(slab),
        [&](std::int32_t i, std::int32_t row, std::int32_t first, std::int32_t last) {
          for (std::int32_t n = first; n <= last; ++n)
            along_k ? mark(i, row, n) : mark(i, n, row);
        });
  }
  return bits;
}

/// Throws VoxelBudgetError if scattered triangles touch more bricks than the estimate predicted.
SurfaceBits mark_surface(const GridMesh& mesh, const Slabs& slabs, const Voxmap& map,
                         const ParallelFor& parallel_for, VoxelEstimate estimate,
                         std::uint64_t memory_limit_bytes) {
  SurfaceBits surface{map.base(), map.cells(), {}, {}};
  std::vector<SlabBits> parts(slabs.size());
  parallel_for(slabs.size(), [&](std::size_t s) {
    if (!slabs.triangles(s).empty())
      parts[s] = mark_slab(mesh, slabs, s, surface.base, surface.cells);
  });
  std::size_t count = 0;
  for (const SlabBits& part : parts)
    count += part.bricks.size();
  const auto layer = static_cast<std::size_t>(surface.cells[1] * surface.cells[2]);
  surface.brick_of.assign(layer * slabs.size(), -1);
  estimate.build_bytes = std::max(
      estimate.build_bytes, static_cast<double>(map.bytes()) + kBuildBytesPerBrick * double(count));
  require_affordable(estimate, map.grid(), memory_limit_bytes);
  surface.bricks.reserve(count);
  for (std::size_t s = 0; s < parts.size(); ++s) {
    const auto offset = static_cast<std::int32_t>(surface.bricks.size());
    for (std::size_t c = 0; c < parts[s].brick_of.size(); ++c)
      if (parts[s].brick_of[c] >= 0)
        surface.brick_of[s * layer + c] = parts[s].brick_of[c] + offset;
    surface.bricks.insert(surface.bricks.end(), parts[s].bricks.begin(), parts[s].bricks.end());
    parts[s] = {};
  }
  return surface;
}

/// Whether each group of voxels lies inside.
std::vector<std::uint8_t> judge_groups(const GridMesh& mesh, const Slabs& slabs,
                                       const ClosedShells& shells, const VoxelGroups& groups,
                                       const ParallelFor& parallel_for) {
  std::vector<std::uint8_t> inside(groups.representative.size(), 0);
  if (shells.closed_parts == 0)
    return inside;
  parallel_for(inside.size() - 1, [&](std::size_t n) {
    const VoxelIndex& v = groups.representative[n + 1];  // group 0 is the outside
    const auto slab = static_cast<std::size_t>((v.i - slabs.first(0)) >> 3);
    inside[n + 1] =
        inside_shells(mesh, shells, slabs.triangles(slab), Vec3(v.i + 0.5, v.j + 0.5, v.k + 0.5));
  });
  return inside;
}

/// The voxels of `surface` met by the remaining mesh; the others are inside the solid.
std::vector<BrickMask> bricks_left(const mesh::TriangleMesh& left, const Voxmap& map,
                                   const SurfaceBits& surface, const ParallelFor& parallel_for) {
  const GridMesh mesh(left, Grid{Vec3::Zero(), 1.0});
  const Slabs slabs(mesh, surface.base.i, static_cast<std::size_t>(surface.cells[0]));
  const SurfaceBits marked = mark_surface(mesh, slabs, map, parallel_for, {}, ~std::uint64_t{0});
  std::vector<BrickMask> bricks(surface.bricks.size(), BrickMask{});
  for (std::size_t cell = 0; cell < surface.brick_of.size(); ++cell) {
    const std::int32_t brick = surface.brick_of[cell], of = marked.brick_of[cell];
    if (brick < 0 || of < 0)
      continue;
    const BrickMask &all = surface.bricks[static_cast<std::size_t>(brick)],
                    &kept = marked.bricks[static_cast<std::size_t>(of)];
    for (std::size_t z = 0; z < 8; ++z)
      bricks[static_cast<std::size_t>(brick)][z] = all[z] & kept[z];
  }
  return bricks;
}

/// `left`: for each brick, the surface of the solid; empty: all of it.
void write_map(const SurfaceBits& surface, const std::vector<BrickMask>& left,
               const VoxelGroups& groups, const std::vector<std::uint8_t>& inside, Voxmap& map) {
  map.reserve_bricks(surface.bricks.size());
  map.for_each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto cell = static_cast<std::size_t>((x * surface.cells[1] + y) * surface.cells[2] + z);
    const std::int32_t brick = surface.brick_of[cell];
    if (brick < 0) {
      if (inside[groups.group[cell]])
        map.fill_cell(surface.first_voxel(cell), VoxelKind::kInterior);
      return;
    }
    BrickMask interior{};
    for (std::uint32_t p = groups.first_piece[static_cast<std::size_t>(brick)];
         p < groups.first_piece[static_cast<std::size_t>(brick) + 1]; ++p)
      if (inside[groups.group[surface.brick_of.size() + p]])
        for (std::size_t z8 = 0; z8 < 8; ++z8)
          interior[z8] |= groups.pieces[p].voxels[z8];
    const BrickMask& all = surface.bricks[static_cast<std::size_t>(brick)];
    const BrickMask& kept = left.empty() ? all : left[static_cast<std::size_t>(brick)];
    for (std::size_t z8 = 0; z8 < 8; ++z8)
      interior[z8] |= all[z8] & ~kept[z8];
    map.set_cell(surface.first_voxel(cell), kept, interior);
  });
  map.finish();
}

}  // namespace

Voxmap voxelise(const mesh::TriangleMesh& mesh, const Grid& grid, const ParallelFor& parallel_for,
                std::uint64_t memory_limit_bytes) {
  const VoxelEstimate estimate = estimate_voxels(mesh, grid);
  require_affordable(estimate, grid, memory_limit_bytes);
  const auto corner = [](const std::array<double, 3>& v) {
    return VoxelIndex{static_cast<std::int32_t>(v[0]), static_cast<std::int32_t>(v[1]),
                      static_cast<std::int32_t>(v[2])};
  };
  Voxmap map(grid, corner(estimate.first), corner(estimate.last));
  const GridMesh in_grid(mesh, grid);
  const Slabs slabs(in_grid, map.base().i, static_cast<std::size_t>(map.cells()[0]));
  const SurfaceBits surface =
      mark_surface(in_grid, slabs, map, parallel_for, estimate, memory_limit_bytes);

  const ClosedShells shells = find_closed_shells(in_grid);
  const VoxelGroups groups = group_voxels(surface, parallel_for);
  const SolidSurface solid = solid_surface(in_grid, shells);
  const std::vector<BrickMask> left =
      solid.whole ? std::vector<BrickMask>{} : bricks_left(solid.mesh, map, surface, parallel_for);
  const std::vector<std::uint8_t> inside =
      judge_groups(in_grid, slabs, shells, groups, parallel_for);
  write_map(surface, left, groups, inside, map);

  return map;
}

}  // namespace voxtouch::voxmap
