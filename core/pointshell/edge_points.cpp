#include "core/pointshell/edge_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/outward.hpp"

namespace voxtouch::pointshell {
namespace {

/// A triangle's side, its ends welded and in ascending order.
struct Side {
  std::uint32_t low = 0, high = 0, triangle = 0, opposite = 0;  ///< opposite: the corner that is not of the side
  bool same_edge(const Side& other) const noexcept { return low == other.low && high == other.high; }
  auto operator<=>(const Side&) const = default;
};

std::vector<Side> sides_of_closed_parts(const voxmap::ClosedMesh& mesh) {
  const std::vector<std::uint32_t> welded = voxmap::weld_vertices(mesh.in_grid);
  std::vector<Side> sides;
  for (const std::uint32_t t : voxmap::triangles_of_closed_parts(mesh.shells)) {
    const std::array<std::uint32_t, 3>& corners = (*mesh.in_grid.triangles)[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[corners[k]], b = welded[corners[(k + 1) % 3]];
      if (a != b) sides.push_back({std::min(a, b), std::max(a, b), t, welded[corners[(k + 2) % 3]]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

using Cell = std::array<std::int64_t, 3>;

/// Adds the points of the edge from `a` to `b`, grid coordinates; `inward` sums up where points share a cell.
void add_edge(const Vec3& a, const Vec3& b, const Vec3& inward, std::map<Cell, ShellPoint>& points) {
  const double pieces = std::max(1.0, std::ceil((b - a).norm() / kEdgePointsApart));
  for (double n = 0.0; n <= pieces; ++n) {
    const Vec3 u = n < pieces ? Vec3(a + n / pieces * (b - a)) : b, in_cells = u / kEdgePointsCell;
    const auto whole = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
    const Cell cell{whole(in_cells.x()), whole(in_cells.y()), whole(in_cells.z())};
    const auto [place, fresh] = points.try_emplace(cell);
    ShellPoint& point = place->second;
    if (fresh) {
      const auto voxel = [&](double x) { return static_cast<std::int32_t>(whole(x)); };
      point.voxel = {voxel(u.x()), voxel(u.y()), voxel(u.z())};
      point.point = u;
      point.normal = inward;
    } else {
      point.normal += inward;
    }
  }
}

}  // namespace

Pointshell edge_points(const voxmap::ClosedMesh& mesh, const voxmap::Grid& grid) {
  const std::vector<std::int8_t> outward = voxmap::outward_sides(mesh.in_grid, mesh.shells);
  const std::vector<Side> sides = sides_of_closed_parts(mesh);
  const auto normal_of = [&](std::uint32_t t) -> Vec3 {
    const Vec3 &a = mesh.in_grid.corner(t, 0), &b = mesh.in_grid.corner(t, 1), &c = mesh.in_grid.corner(t, 2);
    return outward[t] * (b - a).cross(c - a).stableNormalized();
  };
  std::map<Cell, ShellPoint> points;
  for (std::size_t n = 0, next = 0; n < sides.size(); n = next) {
    for (next = n + 1; next < sides.size() && sides[next].same_edge(sides[n]);) ++next;
    if (next - n != 2) continue;
    const Vec3 one = normal_of(sides[n].triangle), other = normal_of(sides[n + 1].triangle);
    const Vec3 &a = mesh.in_grid.u[sides[n].low], &b = mesh.in_grid.u[sides[n].high];
    const bool convex = one.dot(mesh.in_grid.u[sides[n + 1].opposite] - a) < 0.0;
    if (!convex || one.isZero() || other.isZero() || one.dot(other) > std::cos(kSharpRad)) continue;
    add_edge(a, b, -(one + other).stableNormalized(), points);
  }
  std::vector<ShellPoint> kept;
  kept.reserve(points.size());
  for (auto& [cell, point] : points) {
    point.point *= grid.edge;
    point.normal = point.normal.squaredNorm() > kNormalsCancel * kNormalsCancel ? Vec3(point.normal.normalized()) : Vec3::UnitZ();
    kept.push_back(point);
  }
  return make_exact_shell(kept, grid);
}

}  // namespace voxtouch::pointshell
