#include "core/voxmap/grid_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/voxmap/voxmap.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr double kTiny = 0x1p-300;

void check_edge(double edge) {
  if (!(edge > 0.0) || !std::isfinite(edge))
    throw std::runtime_error("voxel size must be a positive number of metres, got " +
                             std::to_string(edge));
}

struct Bounds {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

/// Bounds over the vertices used by triangles; names an unusable vertex or triangle.
void add_bounds(const mesh::TriangleMesh& mesh, Bounds& bounds) {
  if (mesh.empty())
    throw std::runtime_error("the mesh has no triangles to voxelise");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertices.size())
        throw std::runtime_error("triangle " + std::to_string(t) + " has vertex index " +
                                 std::to_string(v) + " of " + std::to_string(mesh.vertices.size()));
      const Vec3& x = mesh.vertices[v];
      if (!x.allFinite())
        throw std::runtime_error("vertex " + std::to_string(v) + " of triangle " +
                                 std::to_string(t) + " is not finite: repair the mesh");
      bounds.low = bounds.low.cwiseMin(x);
      bounds.high = bounds.high.cwiseMax(x);
    }
}

std::string in_units(double bytes) {
  static constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  int unit = 0;
  for (; bytes >= 1024.0 && unit < 6; ++unit)
    bytes /= 1024.0;
  char text[48];
  std::snprintf(text, sizeof text, "%.3g %s", bytes, kUnits[unit]);
  for (char* c = text; *c; ++c)
    if (*c == ',')
      *c = '.';  // independent of the locale's decimal point
  return text;
}

std::string in_metres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", metres);
  for (char* c = text; *c; ++c)
    if (*c == ',')
      *c = '.';
  return std::string(text) + " m";
}

/// Expected number of cells of `edge_m` that the surface meets. A plane patch of area A meets 1 to
/// 2 cells per A / edge^2; a slender patch as many as its length implies; triangles smaller than a
/// cell share theirs.
double expected_cells(const mesh::TriangleMesh& mesh, double edge_m) {
  double sum = 8.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 side = (mesh.vertices[t[1]] - mesh.vertices[t[0]]) / edge_m;
    const Vec3 other = (mesh.vertices[t[2]] - mesh.vertices[t[0]]) / edge_m;
    const double length = side.norm() + other.norm();
    sum += std::max(side.cross(other).norm(), length > 4.0 ? 1.5 * length : 0.0);
  }
  return sum;
}

}  // namespace

Grid default_grid(const mesh::TriangleMesh& mesh, double edge) {
  check_edge(edge);
  Bounds bounds;
  add_bounds(mesh, bounds);
  Grid grid;
  grid.edge = edge;
  for (int axis = 0; axis < 3; ++axis)
    grid.origin[axis] = edge * (std::floor(bounds.low[axis] / edge) - 1.0);
  return grid;
}

VoxelEstimate estimate_voxels(const mesh::TriangleMesh& mesh, const Grid& grid) {
  check_edge(grid.edge);
  if (!grid.origin.allFinite())
    throw std::runtime_error("the grid's origin is not finite");
  Bounds bounds;
  add_bounds(mesh, bounds);
  VoxelEstimate estimate;
  estimate.extent_m = (bounds.high - bounds.low).maxCoeff();
  const Vec3 low = grid.to_grid(bounds.low), high = grid.to_grid(bounds.high);
  estimate.voxels = 1.0;
  std::array<double, 3> cells{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    estimate.first[axis] =
        std::ceil(low[a]) - 1.0;  // closed voxels: a vertex on a border belongs to both
    estimate.last[axis] = std::floor(high[a]);
    estimate.voxels *= estimate.last[axis] - estimate.first[axis] + 1.0;
    cells[axis] =
        std::floor((estimate.last[axis] - estimate.first[axis]) / Voxmap::kBrickEdge) + 4.0;
  }
  const double all = estimate.table_cells = cells[0] * cells[1] * cells[2];
  const double bricks = std::min(expected_cells(mesh, grid.edge * Voxmap::kBrickEdge), all);
  estimate.surface_voxels = std::min(expected_cells(mesh, grid.edge), estimate.voxels);
  // Blocks of cells, pages of those with surface, and a table of all cells if it is small. Building
  // adds an index and two labels per cell, and three masks per brick.
  double distances = 8.0 * all;
  if (all <= static_cast<double>(Voxmap::kMaxTableCells)) {
    const std::array<std::int64_t, 3> whole{static_cast<std::int64_t>(cells[0]),
                                            static_cast<std::int64_t>(cells[1]),
                                            static_cast<std::int64_t>(cells[2])};
    distances = static_cast<double>(free_distance::bytes_of(
        whole, free_distance::shift_for(whole, static_cast<std::size_t>(estimate.surface_voxels))));
  }
  const double blocks = all / (Voxmap::kBlockEdge * Voxmap::kBlockEdge * Voxmap::kBlockEdge),
               table = 4.0 * all;
  const double pages =
      std::min(expected_cells(mesh, grid.edge * Voxmap::kBrickEdge * Voxmap::kBlockEdge), blocks);
  estimate.bytes = sizeof(Voxmap::Block) * blocks + sizeof(Voxmap::Page) * pages +
                   (table <= Voxmap::kFewTableBytes ? table : 0.0) + distances +
                   sizeof(Voxmap::Brick) * bricks;
  estimate.build_bytes = estimate.bytes + 12.0 * all + 4.0 * 64.0 * bricks +
                         static_cast<double>(mesh.vertices.size()) * 28.0 +
                         static_cast<double>(mesh.triangles.size()) * 60.0;
  return estimate;
}

void require_affordable(const VoxelEstimate& estimate, const Grid& grid,
                        std::uint64_t limit_bytes) {
  const std::string what = "a mesh " + in_metres(estimate.extent_m) + " long at a voxel size of " +
                           in_metres(grid.edge) + " needs about " + in_units(estimate.build_bytes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(estimate.first[axis] > -kMaxVoxelIndex && estimate.last[axis] < kMaxVoxelIndex))
      throw VoxelBudgetError(what +
                             " and voxel indices beyond 2^30: use a larger voxel size, or a grid "
                             "origin near the mesh");
  if (!(estimate.build_bytes <= static_cast<double>(limit_bytes)))
    throw VoxelBudgetError(
        what + ", limit " + in_units(static_cast<double>(limit_bytes)) +
        ": use a larger voxel size, or check the mesh's scale (file in millimetres)");
  if (!(estimate.table_cells <= static_cast<double>(Voxmap::kMaxTableCells)))
    throw VoxelBudgetError(what + " and a table of more than 2^28 bricks: use a larger voxel size");
}

GridMesh::GridMesh(const mesh::TriangleMesh& mesh, const Grid& grid) : triangles(&mesh.triangles) {
  u.reserve(mesh.vertices.size());
  for (const Vec3& x : mesh.vertices) {
    Vec3 v = grid.to_grid(x);
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(v[axis]) < kTiny)
        v[axis] = 0.0;  // also changes -0 to 0
    u.push_back(v);
  }
}

}  // namespace voxtouch::voxmap
