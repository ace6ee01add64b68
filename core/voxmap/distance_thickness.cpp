#include "core/voxmap/distance_thickness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();
/// Barycentric position in a triangle: asymmetric, so that the ray meets no vertex or edge on the
/// other side of regular meshes.
constexpr double kSpotA = 0.31, kSpotB = 0.42, kSpotC = 0.27;

struct Crossing {
  double at;    ///< along the ray [voxels]
  int winding;  ///< winding number ahead of the crossing minus that behind it
};

/// Intersection of ray and triangle (Moeller and Trumbore 1997), beyond `from`; `out` is +1 if the
/// ray leaves by the front.
bool meets(const GridMesh& mesh, std::uint32_t triangle, const Vec3& origin, const Vec3& direction,
           double& at, int& out) {
  const Vec3 a = mesh.corner(triangle, 1) - mesh.corner(triangle, 0),
             b = mesh.corner(triangle, 2) - mesh.corner(triangle, 0);
  const Vec3 p = direction.cross(b);
  const double determinant = a.dot(p);
  if (determinant == 0.0)
    return false;
  const Vec3 from = origin - mesh.corner(triangle, 0);
  const double u = from.dot(p) / determinant;
  const Vec3 q = from.cross(a);
  const double v = direction.dot(q) / determinant;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0))
    return false;
  at = b.dot(q) / determinant;
  out = determinant < 0.0 ? 1 : -1;
  return true;
}

/// Length of solid from `origin`, which lies on triangle `own`, along `direction`; infinite without
/// solid.
double solid_ahead(const GridMesh& mesh, const ClosedShells& shells, const DistanceTree& tree,
                   std::uint32_t own, const Vec3& origin, const Vec3& direction) {
  std::vector<Crossing> crossings;
  int winding = 0, parity = 0;
  tree.each_on_ray(origin, direction, [&](std::uint32_t triangle) {
    double at = 0.0;
    int out = 0;
    if (triangle == own || !meets(mesh, triangle, origin, direction, at, out) || at < 0.0)
      return;
    const ShellRole role = shells.role[triangle];
    if (role == ShellRole::kParity) {
      parity ^= 1;
      crossings.push_back({at, 0});
    } else {
      crossings.push_back({at, role == ShellRole::kFlipped ? -out : out});
      winding += crossings.back().winding;
    }
  });
  if (winding == 0 && parity == 0)
    return kNowhere;
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
  for (const Crossing& crossing : crossings) {
    winding -= crossing.winding;
    parity ^= crossing.winding == 0;
    if (winding == 0 && parity == 0)
      return crossing.at;
  }
  return kNowhere;
}

}  // namespace

ThinnestWall thinnest_wall(const ClosedMesh& mesh, const Grid& grid,
                           const ParallelFor& parallel_for, std::size_t most_rays) {
  const GridMesh& in_grid = mesh.in_grid;
  const ClosedShells& shells = mesh.shells;
  const std::vector<std::uint32_t> chosen = triangles_of_closed_parts(shells);
  const std::size_t stride = chosen.size() / std::max<std::size_t>(most_rays, 1) + 1;
  std::vector<double> found((chosen.size() + stride - 1) / stride, kNowhere);
  parallel_for(found.size(), [&](std::size_t n) {
    const std::uint32_t t = chosen[n * stride];
    const Vec3 &a = in_grid.corner(t, 0), &b = in_grid.corner(t, 1), &c = in_grid.corner(t, 2);
    const Vec3 normal = area_vector(a, b, c).stableNormalized();
    if (normal.isZero(0.0))
      return;
    const Vec3 spot = kSpotA * a + kSpotB * b + kSpotC * c;
    const double behind = solid_ahead(in_grid, shells, mesh.tree, t, spot, -normal);
    const double before = solid_ahead(in_grid, shells, mesh.tree, t, spot, normal);
    // Solid on both sides: a wall inside overlapping parts, not a surface.
    if (std::isinf(behind) != std::isinf(before))
      found[n] = std::min(behind, before);
  });
  ThinnestWall out{kNowhere, 0};
  for (std::size_t n = 0; n < found.size(); ++n)
    if (grid.edge * found[n] < out.thickness_m)
      out = {grid.edge * found[n], chosen[n * stride]};
  return out;
}

}  // namespace voxtouch::voxmap
