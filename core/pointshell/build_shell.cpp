#include "core/pointshell/build_shell.hpp"

#include <algorithm>
#include <bit>

namespace voxtouch::pointshell {
namespace {

/// Bits of the lower 21 go three apart.
std::uint64_t every_third_bit(std::uint64_t n) noexcept {
  n &= 0x1fffffULL;
  n = (n | n << 32) & 0x001f00000000ffffULL;
  n = (n | n << 16) & 0x001f0000ff0000ffULL;
  n = (n | n << 8) & 0x100f00f00f00f00fULL;
  n = (n | n << 4) & 0x10c30c30c30c30c3ULL;
  return (n | n << 2) & 0x1249249249249249ULL;
}

/// Ranks of the points in Morton order of their voxels, counted from the lowest index along each
/// axis.
std::vector<std::uint32_t> morton_order(const std::vector<ShellPoint>& points) {
  std::array<std::int64_t, 3> low{INT64_MAX, INT64_MAX, INT64_MAX},
      high{INT64_MIN, INT64_MIN, INT64_MIN};
  const auto index = [](const ShellPoint& p) {
    return std::array<std::int64_t, 3>{p.voxel.i, p.voxel.j, p.voxel.k};
  };
  for (const ShellPoint& p : points)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], index(p)[axis]);
      high[axis] = std::max(high[axis], index(p)[axis]);
    }
  // An object longer than 2^21 voxels is ordered by coarser cells; within one, by rank.
  int shift = 0;
  for (std::size_t axis = 0; axis < 3 && !points.empty(); ++axis) {
    const auto length = static_cast<std::uint64_t>(high[axis] - low[axis]);
    shift = std::max(shift, static_cast<int>(std::bit_width(length)) - 21);
  }
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(points.size());
  for (std::uint32_t rank = 0; rank < points.size(); ++rank) {
    std::uint64_t key = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto offset = static_cast<std::uint64_t>(index(points[rank])[axis] - low[axis]);
      key |= every_third_bit(offset >> shift) << axis;
    }
    keyed[rank] = {key, rank};
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t n = 0; n < order.size(); ++n)
    order[n] = keyed[n].second;
  return order;
}

template <class Position>
Pointshell arrange(const std::vector<ShellPoint>& points, const voxmap::Grid& grid,
                   Position&& position) {
  Pointshell shell;
  shell.edge = grid.edge;
  shell.id = morton_order(points);
  for (auto* column : {&shell.x, &shell.y, &shell.z, &shell.nx, &shell.ny, &shell.nz,
                       &shell.area_m2, &shell.coherence})
    column->reserve(points.size());
  for (const std::uint32_t rank : shell.id) {
    const ShellPoint& p = points[rank];
    const Vec3 x = position(p);
    shell.x.push_back(x.x()), shell.y.push_back(x.y()), shell.z.push_back(x.z());
    shell.nx.push_back(p.normal.x()), shell.ny.push_back(p.normal.y()),
        shell.nz.push_back(p.normal.z());
    shell.area_m2.push_back(p.area_m2), shell.coherence.push_back(p.coherence);
  }
  return shell;
}

}  // namespace

/// One pass: each neighbour is sought ahead of its voxel by a pointer that only moves forward.
double largest_gap_m(const std::vector<ShellPoint>& points) {
  double largest = 0.0;
  std::array<std::size_t, 3> ahead{};
  for (const ShellPoint& p : points) {
    const voxmap::VoxelIndex& v = p.voxel;
    const std::array<voxmap::VoxelIndex, 3> next{
        {{v.i + 1, v.j, v.k}, {v.i, v.j + 1, v.k}, {v.i, v.j, v.k + 1}}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::size_t& at = ahead[axis];
      while (at < points.size() && points[at].voxel < next[axis])
        ++at;
      if (at < points.size() && points[at].voxel == next[axis])
        largest = std::max(largest, (p.point - points[at].point).norm());
    }
  }
  return largest;
}

Pointshell make_exact_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid) {
  return arrange(points, grid, [](const ShellPoint& p) { return p.point; });
}

Pointshell make_naive_shell(const std::vector<ShellPoint>& points, const voxmap::Grid& grid) {
  return arrange(points, grid, [&](const ShellPoint& p) { return grid.centre(p.voxel); });
}

}  // namespace voxtouch::pointshell
