#include "core/rendering/one_solid.hpp"

#include <algorithm>
#include <numeric>

#include "core/voxmap/brick_bits.hpp"

namespace voxtouch::rendering {
namespace {

struct Bounds {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  bool meets(const Bounds& o, double gap_m) const noexcept {
    return (low.array() <= o.high.array() + gap_m).all() &&
           (o.low.array() <= high.array() + gap_m).all();
  }
};

Bounds bounds_of(const mesh::TriangleMesh& mesh) {
  Bounds bounds;
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) {
      bounds.low = bounds.low.cwiseMin(mesh.vertices[v]);
      bounds.high = bounds.high.cwiseMax(mesh.vertices[v]);
    }
  return bounds;
}

}  // namespace

std::vector<std::vector<std::size_t>> solids_of(std::span<const mesh::TriangleMesh> meshes,
                                                const std::vector<bool>& rests, double gap_m) {
  std::vector<Bounds> bounds;
  for (const mesh::TriangleMesh& mesh : meshes)
    bounds.push_back(bounds_of(mesh));
  std::vector<std::size_t> group(meshes.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto takes_part = [&](std::size_t n) { return rests[n] && !meshes[n].empty(); };
  for (std::size_t a = 0; a < meshes.size(); ++a)
    for (std::size_t b = a + 1; b < meshes.size(); ++b) {
      if (!takes_part(a) || !takes_part(b) || !bounds[a].meets(bounds[b], gap_m))
        continue;
      const std::size_t from = std::max(group[a], group[b]), to = std::min(group[a], group[b]);
      std::ranges::replace(group, from, to);
    }
  std::vector<std::vector<std::size_t>> solids;
  for (std::size_t first = 0; first < meshes.size(); ++first) {
    std::vector<std::size_t> members;
    for (std::size_t n = 0; n < meshes.size(); ++n)
      if (group[n] == first && takes_part(n))
        members.push_back(n);
    if (members.size() > 1)
      solids.push_back(std::move(members));
  }
  return solids;
}

voxmap::Voxmap owned_part(const voxmap::Voxmap& solid, const voxmap::Voxmap& own,
                          std::span<const voxmap::Voxmap* const> others) {
  constexpr std::int32_t kEdge = voxmap::Voxmap::kBrickEdge;
  const auto& cells = own.cells();
  const voxmap::VoxelIndex& base = own.base();
  const auto last = [&](std::int32_t first, std::int64_t count) {
    return first + static_cast<std::int32_t>(kEdge * count) - 1;
  };
  voxmap::Voxmap part(own.grid(), base,
                      {last(base.i, cells[0]), last(base.j, cells[1]), last(base.k, cells[2])});
  const auto of_another = [&](const voxmap::VoxelIndex& v) {
    return std::ranges::any_of(
        others, [&](const voxmap::Voxmap* map) { return map->at(v) != voxmap::VoxelKind::kFree; });
  };
  own.for_each_cell([&](std::int64_t x, std::int64_t y, std::int64_t z) {
    const voxmap::VoxelIndex first{base.i + static_cast<std::int32_t>(kEdge * x),
                                   base.j + static_cast<std::int32_t>(kEdge * y),
                                   base.k + static_cast<std::int32_t>(kEdge * z)};
    voxmap::BrickMask surface{}, interior{};
    bool all_interior = true;
    for (int n = 0; n < kEdge * kEdge * kEdge; ++n) {
      const voxmap::VoxelIndex v{first.i + (n & 7), first.j + (n >> 3 & 7), first.k + (n >> 6)};
      const bool mine = own.at(v) != voxmap::VoxelKind::kFree && !of_another(v);
      const voxmap::VoxelKind kind = mine ? solid.at(v) : voxmap::VoxelKind::kFree;
      const std::uint64_t bit = std::uint64_t{1} << (n & 63);
      if (kind == voxmap::VoxelKind::kSurface)
        surface[static_cast<std::size_t>(n >> 6)] |= bit;
      if (kind == voxmap::VoxelKind::kInterior)
        interior[static_cast<std::size_t>(n >> 6)] |= bit;
      all_interior = all_interior && kind == voxmap::VoxelKind::kInterior;
    }
    if (all_interior)
      part.fill_cell(first, voxmap::VoxelKind::kInterior);
    else if (voxmap::any(surface) || voxmap::any(interior))
      part.set_cell(first, surface, interior);
  });
  part.finish();
  return part;
}

}  // namespace voxtouch::rendering
