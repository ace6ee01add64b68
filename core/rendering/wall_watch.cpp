#include "core/rendering/wall_watch.hpp"

#include <algorithm>
#include <numeric>

#include "core/rendering/proximity_field.hpp"

namespace voxtouch::rendering {
namespace {

std::vector<std::uint32_t> all_of(const mesh::TriangleMesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

/// Every n-th shell point, moved inwards along its normal.
std::vector<Vec3> points_inside(const pointshell::Pointshell& shell, double inside_m) {
  std::vector<Vec3> points;
  const std::size_t every = std::max<std::size_t>(1, shell.size() / WallWatch::kMostPoints);
  for (std::size_t p = 0; p < shell.size() && points.size() < WallWatch::kMostPoints; p += every)
    points.push_back(shell.point(p) + inside_m * shell.normal(p));
  return points;
}

/// Six times the volume of the tetrahedron.
double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace

WallWatch::WallWatch(mesh::TriangleMesh walls, const pointshell::Pointshell& shell, double inside_m)
    : walls_(std::move(walls)),
      mesh_(walls_, voxmap::Grid{Vec3::Zero(), 1.0}),
      tree_(mesh_, all_of(walls_)),
      points_(points_inside(shell, inside_m)) {}

bool WallWatch::passed(const Pose& from, const Pose& to) const noexcept {
  return std::ranges::any_of(points_, [&](const Vec3& p) { return crosses(from * p, to * p); });
}

bool WallWatch::crosses(const Vec3& from, const Vec3& to) const noexcept {
  const Vec3 displacement = to - from;
  if (displacement.isZero(0.0))
    return false;
  bool crossed = false;
  tree_.each_on_ray(from, displacement, [&](std::uint32_t t) {
    const Vec3 &a = mesh_.corner(t, 0), &b = mesh_.corner(t, 1), &c = mesh_.corner(t, 2);
    if (volume(a, b, c, from) * volume(a, b, c, to) >= 0.0)
      return;
    const double u = volume(from, to, a, b), v = volume(from, to, b, c), w = volume(from, to, c, a);
    crossed |= (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
  });
  return crossed;
}

}  // namespace voxtouch::rendering
