#include "tests/experiments/exact_truth/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/reference/reference_mesh.hpp"
#include "tests/support/exact_shapes/shapes.hpp"

namespace voxtouch::exact_truth {
namespace {

constexpr double kRadius = 0.02, kHalfLength = 0.03;  // of the cylinders [m]

/// Along z; `sides` facets of `rings` squares each, two triangles a square, and two lids.
mesh::TriangleMesh cylinder(std::uint32_t sides, std::uint32_t rings) {
  mesh::TriangleMesh out;
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    const double z = kHalfLength * (2.0 * ring / rings - 1.0);
    for (std::uint32_t side = 0; side < sides; ++side) {
      const double angle = 2.0 * std::numbers::pi * side / sides;
      out.vertices.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), z});
    }
  }
  const auto low = static_cast<std::uint32_t>(out.vertices.size()), high = low + 1;
  out.vertices.push_back({0.0, 0.0, -kHalfLength});
  out.vertices.push_back({0.0, 0.0, kHalfLength});
  for (std::uint32_t side = 0; side < sides; ++side) {
    const std::uint32_t next = (side + 1) % sides, top = rings * sides;
    for (std::uint32_t ring = 0; ring < rings; ++ring) {
      const std::uint32_t here = ring * sides, above = here + sides;
      out.triangles.push_back({here + side, here + next, above + next});
      out.triangles.push_back({here + side, above + next, above + side});
    }
    out.triangles.push_back({low, next, side});
    out.triangles.push_back({high, top + side, top + next});
  }
  return out;
}

mesh::TriangleMesh cup() {
  scene::MeshSpec spec;
  spec.path = std::string(VOXTOUCH_DEPLOY) + "/meshes/cup.obj";
  const reference::ReferenceMesh read = reference::read_reference_mesh(spec);
  return {read.vertices, read.triangles};
}

}  // namespace

Surface surface(const std::string& name) {
  if (name == "plane")
    return {name, test::box({-0.1, -0.1, -0.02}, {0.1, 0.1, 0.0}), 0.02};
  if (name == "cylinder")
    return {name, cylinder(100, 24), 0.01};
  if (name == "fine_cylinder")
    return {name, cylinder(1000, 249), 0.01};
  if (name == "cup")
    return {name, cup(), 0.0};
  throw std::invalid_argument("unknown surface '" + name +
                              "'. Use plane, cylinder, fine_cylinder or cup");
}

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Quat random_rotation(std::mt19937_64& random) {
  const double u = uniform(random), a = 2.0 * std::numbers::pi * uniform(random),
               b = 2.0 * std::numbers::pi * uniform(random);
  const double s = std::sqrt(1.0 - u), t = std::sqrt(u);
  return {t * std::cos(b), s * std::sin(a), s * std::cos(a), t * std::sin(b)};
}

Spot random_spot(const Surface& surface, std::mt19937_64& random) {
  const mesh::TriangleMesh& mesh = surface.mesh;
  if (surface.name == "plane") {
    const double half = 0.1 - surface.keep_m;
    const double x = half * (2.0 * uniform(random) - 1.0), y = half * (2.0 * uniform(random) - 1.0);
    return {{x, y, 0.0}, Vec3::UnitZ()};
  }
  if (surface.name != "cup") {
    const double angle = 2.0 * std::numbers::pi * uniform(random);
    const Vec3 normal(std::cos(angle), std::sin(angle), 0.0);
    const double z = (kHalfLength - surface.keep_m) * (2.0 * uniform(random) - 1.0);
    return {kRadius * normal + Vec3(0.0, 0.0, z), normal};
  }
  std::vector<double> sums;
  double area = 0.0;
  const auto across = [&mesh](std::size_t t) {
    return Vec3(
        (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0)));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    sums.push_back(area += across(t).norm());
  const auto found = std::upper_bound(sums.begin(), sums.end(), area * uniform(random));
  const auto t = static_cast<std::size_t>(std::min(found, sums.end() - 1) - sums.begin());
  const double r = std::sqrt(uniform(random)), v = uniform(random);
  return {
      (1.0 - r) * mesh.corner(t, 0) + r * (1.0 - v) * mesh.corner(t, 1) + r * v * mesh.corner(t, 2),
      across(t).normalized()};
}

}  // namespace voxtouch::exact_truth
