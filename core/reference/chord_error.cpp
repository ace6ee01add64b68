#include "core/reference/chord_error.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/reference/closed_forms.hpp"

namespace voxtouch {
namespace {

constexpr std::size_t kSamplesPerPrimitive = 1200;

/// Keeps the larger of both errors and where it was seen.
void widen(double& largest, double found, const Vec3& where, ChordError& error) {
  if (found > error.value_m()) error.worst = where;
  largest = std::max(largest, found);
}

}  // namespace

ChordError chord_error(const ReferenceMesh& mesh, const MeshDistance& distance, const std::vector<Primitive>& primitives) {
  ChordError error;
  const auto off_primitives = [&](const Vec3& x) {
    widen(error.mesh_to_primitives_m, std::abs(signed_distance(primitives, x).distance_m), x, error);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    for (const Vec3& x : {a, b, c, Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2), Vec3((a + b + c) / 3)})
      off_primitives(x);
  }
  for (const Primitive& primitive : primitives)
    for (const Vec3& x : surface_samples(primitive, kSamplesPerPrimitive)) {
      const double buried = -signed_distance(primitives, x).distance_m;
      if (const double off = distance.nearest(x).distance_m; buried < 0.5 * off)
        widen(error.primitives_to_mesh_m, off, x, error);
    }
  return error;
}

std::optional<std::string> primitives_problem(const MeshSpec& spec, double edge_m) {
  if (spec.primitives.empty()) return std::nullopt;
  const ReferenceMesh mesh = read_reference_mesh(spec);
  const ChordError error = chord_error(mesh, MeshDistance(mesh), spec.primitives);
  const double limit = kChordShareOfEdge * edge_m;
  if (error.value_m() <= limit) return std::nullopt;
  return fmt::format(
      "{}: the declared primitives differ from the mesh by {:.3g} m at ({:.4g}, {:.4g}, {:.4g}), more than {:.3g} m "
      "({:g} of the voxel edge); correct the primitives, refine the mesh or declare none",
      spec.path.string(), error.value_m(), error.worst.x(), error.worst.y(), error.worst.z(), limit, kChordShareOfEdge);
}

}  // namespace voxtouch
