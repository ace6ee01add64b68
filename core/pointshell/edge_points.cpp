#include "core/pointshell/edge_points.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/outward.hpp"

namespace voxtouch::pointshell {
namespace {

/// Triangles of a closed part that meet at so flat an angle enclose nothing between them [rad].
constexpr double kNoThickness = 1e-6;

/// A triangle's side, its ends welded and in ascending order.
struct Side {
  std::uint32_t low = 0, high = 0, triangle = 0,
                opposite = 0;  ///< opposite: the corner that is not of the side
  bool same_edge(const Side& other) const noexcept {
    return low == other.low && high == other.high;
  }
  auto operator<=>(const Side&) const = default;
};

std::vector<Side> sides_of(const voxmap::GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                           const std::vector<std::uint32_t>& triangles) {
  std::vector<Side> sides;
  for (const std::uint32_t t : triangles) {
    const std::array<std::uint32_t, 3>& corners = (*mesh.triangles)[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = welded[corners[k]], b = welded[corners[(k + 1) % 3]];
      if (a != b)
        sides.push_back({std::min(a, b), std::max(a, b), t, welded[corners[(k + 2) % 3]]});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Sides that are one edge.
using Meeting = std::span<const Side>;

template <class F>
void for_each_edge(const std::vector<Side>& sides, F&& f) {
  for (std::size_t n = 0, next = 0; n < sides.size(); n = next) {
    for (next = n + 1; next < sides.size() && sides[next].same_edge(sides[n]);)
      ++next;
    f(Meeting(sides).subspan(n, next - n));
  }
}

/// The mean of the ways from the edge into its triangles, in their planes: unit. Zero where they do
/// not all lead to one side of the edge by half of kSharpRad at least, so that it stands out of
/// none of them.
Vec3 inward_of(const voxmap::GridMesh& mesh, Meeting edge) {
  const Vec3 &a = mesh.u[edge[0].low], along = (mesh.u[edge[0].high] - a).stableNormalized();
  const auto into = [&](const Side& side) -> Vec3 {
    const Vec3 arm = mesh.u[side.opposite] - a;
    return (arm - arm.dot(along) * along).stableNormalized();
  };
  Vec3 inward = Vec3::Zero();
  for (const Side& side : edge)
    inward += into(side);
  inward = inward.stableNormalized();
  for (const Side& side : edge)
    if (!(into(side).dot(inward) >= std::sin(0.5 * kSharpRad)))
      return Vec3::Zero();
  return inward;
}

using Cell = std::array<std::int64_t, 3>;

/// Adds the points of the edge from `a` to `b`, grid coordinates; `inward` sums up where points
/// share a cell.
void add_edge(const Vec3& a, const Vec3& b, const Vec3& inward,
              std::map<Cell, ShellPoint>& points) {
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

Pointshell edge_points(const voxmap::ClosedMesh& of, const voxmap::Grid& grid) {
  const voxmap::GridMesh& mesh = of.in_grid;
  const std::vector<std::int8_t> outward = voxmap::outward_sides(mesh, of.shells);
  const std::vector<std::uint32_t> welded = voxmap::weld_vertices(mesh);
  std::map<Cell, ShellPoint> points;
  const auto add = [&](Meeting edge) {
    const Vec3 inward = inward_of(mesh, edge);
    if (!inward.isZero(0.0))
      add_edge(mesh.u[edge[0].low], mesh.u[edge[0].high], inward, points);
  };
  for_each_edge(sides_of(mesh, welded, voxmap::triangles_of_closed_parts(of.shells)),
                [&](Meeting edge) {
                  if (edge.size() != 2)
                    return;
                  const std::uint32_t t = edge[0].triangle;
                  const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
                  const Vec3 normal = outward[t] * (b - a).cross(c - a).stableNormalized(),
                             across = mesh.u[edge[1].opposite] - mesh.u[edge[1].low];
                  if (normal.dot(across) <= kNoThickness * across.norm())
                    add(edge);  // convex, or both triangles are one
                });
  for_each_edge(sides_of(mesh, welded, of.shells.open), add);
  std::vector<ShellPoint> kept;
  kept.reserve(points.size());
  for (auto& [cell, point] : points) {
    point.point *= grid.edge;
    point.normal = point.normal.squaredNorm() > kNormalsCancel * kNormalsCancel
                       ? Vec3(point.normal.normalized())
                       : Vec3::UnitZ();
    kept.push_back(point);
  }
  return make_exact_shell(kept, grid);
}

}  // namespace voxtouch::pointshell
