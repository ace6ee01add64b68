#include "core/reference/chord_error.hpp"

#include <cmath>

#include "core/reference/closed_forms.hpp"

namespace voxtouch::reference {
namespace {

constexpr std::size_t kSamplesPerPrimitive = 1200;

}  // namespace

ChordError chord_error(const ReferenceMesh& mesh, const MeshDistance& distance,
                       const std::vector<scene::Primitive>& primitives) {
  ChordError error;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    for (const Vec3& x :
         {a, b, c, Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2), Vec3((a + b + c) / 3)})
      error.mesh_to_primitives_m =
          std::max(error.mesh_to_primitives_m, std::abs(signed_distance(primitives, x).distance_m));
  }
  for (const scene::Primitive& primitive : primitives)
    for (const Vec3& x : surface_samples(primitive, kSamplesPerPrimitive)) {
      const double inside_depth = -signed_distance(primitives, x).distance_m;
      if (const double off = distance.nearest(x).distance_m; inside_depth < 0.5 * off)
        error.primitives_to_mesh_m = std::max(error.primitives_to_mesh_m, off);
    }
  return error;
}

}  // namespace voxtouch::reference
