#include "core/scene_proposal/measure_part.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace voxtouch::scene_proposal {
namespace {

constexpr double kDeskM = 0.15;
constexpr std::size_t kPoints = 400;
constexpr double kWork = 5e7;  ///< rays times triangles
constexpr double kFraction = 0.1;

struct Hit {
  double distance_m;
  bool from_back;  ///< the ray leaves the part there
};

/// Intersection of the line from `from` along `ray` (unit) with the triangle; `distance_m` is
/// infinite without one. Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection"
/// (1997).
Hit hit(const mesh::TriangleMesh& mesh, std::size_t triangle, const Vec3& from, const Vec3& ray) {
  constexpr Hit kNone{std::numeric_limits<double>::infinity(), false};
  const Vec3& a = mesh.corner(triangle, 0);
  const Vec3 ab = mesh.corner(triangle, 1) - a, ac = mesh.corner(triangle, 2) - a;
  const Vec3 p = ray.cross(ac);
  const double determinant = ab.dot(p);  // -ray . (ab x ac)
  if (determinant == 0.0)
    return kNone;
  const Vec3 s = from - a, q = s.cross(ab);
  const double u = s.dot(p) / determinant, v = ray.dot(q) / determinant;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0))
    return kNone;
  return {ac.dot(q) / determinant, determinant < 0.0};
}

}  // namespace

Unit likely_unit(double largest_extent) noexcept {
  const auto off = [&](const Unit& unit) {
    return std::abs(std::log(largest_extent * unit.metres / kDeskM));
  };
  return off(kMillimetre) < off(kMetre) ? kMillimetre : kMetre;
}

std::optional<double> wall_thickness_m(const mesh::TriangleMesh& mesh) {
  std::vector<double> area_up_to;
  double area = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area +=
        0.5 *
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)).norm();
    area_up_to.push_back(area);
  }
  if (!(area > 0.0))
    return {};
  const auto count = std::clamp<std::size_t>(
      static_cast<std::size_t>(kWork / static_cast<double>(mesh.triangles.size())), 20, kPoints);
  const double least = 1e-6 * std::sqrt(area);
  std::vector<double> thickness;
  for (std::size_t n = 0; n < count; ++n) {
    const double at = area * (static_cast<double>(n) + 0.5) / static_cast<double>(count);
    const auto t =
        static_cast<std::size_t>(std::ranges::upper_bound(area_up_to, at) - area_up_to.begin());
    // A deterministic place within the triangle: two steps of the golden ratio's sequence.
    double u = std::fmod(0.754877666 * static_cast<double>(n + 1), 1.0),
           v = std::fmod(0.569840291 * static_cast<double>(n + 1), 1.0);
    if (u + v > 1.0)
      u = 1.0 - u, v = 1.0 - v;
    const Vec3 ab = mesh.corner(t, 1) - mesh.corner(t, 0),
               ac = mesh.corner(t, 2) - mesh.corner(t, 0);
    const Vec3 from = mesh.corner(t, 0) + u * ab + v * ac, inward = -ab.cross(ac).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < mesh.triangles.size(); ++other)
      if (const Hit found = hit(mesh, other, from, inward);
          found.from_back && found.distance_m > least)
        nearest = std::min(nearest, found.distance_m);
    if (std::isfinite(nearest))
      thickness.push_back(nearest);
  }
  if (thickness.size() < count / 2)
    return {};
  const auto tenth = thickness.begin() +
                     static_cast<std::ptrdiff_t>(kFraction * static_cast<double>(thickness.size()));
  std::ranges::nth_element(thickness, tenth);
  return *tenth;
}

Vec3 place_to_touch(const mesh::TriangleMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low, highest = low;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t index : triangle) {
      const Vec3& x = mesh.vertices[index];
      low = low.cwiseMin(x), high = high.cwiseMax(x);
      if (x.z() > highest.z())
        highest = x;
    }
  const double above = high.z() + (high - low).norm();
  const Vec3 from(0.5 * (low.x() + high.x()), 0.5 * (low.y() + high.y()), above);
  double ray = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    ray = std::min(ray, hit(mesh, t, from, -Vec3::UnitZ()).distance_m);
  return std::isfinite(ray) ? Vec3(from - ray * Vec3::UnitZ()) : highest;
}

}  // namespace voxtouch::scene_proposal
