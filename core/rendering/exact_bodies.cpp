#include "core/rendering/exact_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/exact/limits.hpp"
#include "core/exact/simplified.hpp"
#include "core/mesh/weld.hpp"
#include "core/voxmap/closed_shells.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/outward.hpp"

namespace voxtouch::rendering {
namespace {

/// The tool's reach in x' is between this and twice this [m].
constexpr int kReachExponent = -6;

double reach_of(const mesh::TriangleMesh& mesh) {
  double reach = 0.0;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      reach = std::max(reach, mesh.vertices[v].norm());
  if (!(reach > 0.0))
    throw std::invalid_argument("the tool is a point");
  return reach;
}

double scale_for(const mesh::TriangleMesh& tool) {
  return std::ldexp(1.0, kReachExponent - std::ilogb(reach_of(tool)));
}

/// Orients the triangles of all closed parts counter-clockwise as seen from outside.
mesh::TriangleMesh outward(mesh::TriangleMesh mesh, double edge_m) {
  const voxmap::GridMesh in_grid(mesh, voxmap::default_grid(mesh, edge_m));
  const std::vector<std::int8_t> sides =
      voxmap::outward_sides(in_grid, voxmap::find_closed_shells(in_grid));
  for (std::size_t t = 0; t < sides.size(); ++t)
    if (sides[t] < 0)
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  return mesh;
}

mesh::TriangleMesh in_own_frame(mesh::TriangleMesh mesh, const Vec3& origin, double scale) {
  for (Vec3& v : mesh.vertices)
    v = scale * (v - origin);
  return mesh;
}

exact::SimplifiedMesh simplify(const mesh::TriangleMesh& scaled,
                               std::span<const std::uint32_t> owners, double scale) {
  const double most = exact::limits::kSimplifiedM * std::min(1.0, scale);
  return exact::simplify(mesh::weld(scaled), owners, {most, exact::limits::kSimplifiedRad});
}

exact::ToolBody tool_body(const mesh::TriangleMesh& tool, double edge_m, double scale) {
  const mesh::TriangleMesh scaled = in_own_frame(outward(tool, edge_m), Vec3::Zero(), scale);
  return exact::ToolBody(simplify(scaled, {}, scale).mesh);
}

exact::ObjectBody object_body(const ExactBodies::Object& object, const Vec3& origin, double edge_m,
                              double scale) {
  const mesh::TriangleMesh scaled = in_own_frame(outward(object.mesh, edge_m), origin, scale);
  const exact::SimplifiedMesh simplified = simplify(scaled, object.owners, scale);
  if (object.owners.empty())
    return exact::ObjectBody(simplified.mesh);
  std::vector<std::uint32_t> owners;
  for (const std::uint32_t triangle : simplified.triangles)
    owners.push_back(object.owners[triangle]);
  return exact::ObjectBody(simplified.mesh, owners);
}

template <class Build>
auto sound(Build&& build) {
  try {
    return build();
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace

ExactBodies::ExactBodies(const mesh::TriangleMesh& tool, std::span<const Object> objects,
                         double edge_m)
    : scale_(scale_for(tool)),
      origin_(voxmap::default_grid(objects.front().mesh, edge_m).origin),
      tool_(sound([&] { return tool_body(tool, edge_m, scale_); })) {
  bodies_.reserve(objects.size());
  for (const Object& object : objects) {
    bodies_.push_back(sound([&] { return object_body(object, origin_, edge_m, scale_); }));
    leaders_.push_back(object.objects.front());
    objects_.insert(objects_.end(), object.objects.begin(), object.objects.end());
  }
}

std::size_t ExactBodies::bytes() const noexcept {
  std::size_t sum = tool_.bytes();
  for (const exact::ObjectBody& body : bodies_)
    sum += body.bytes();
  return sum;
}

}  // namespace voxtouch::rendering
