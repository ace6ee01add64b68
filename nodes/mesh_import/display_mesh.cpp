#include "nodes/mesh_import/display_mesh.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "nodes/mesh_import/mesh_process.hpp"

namespace voxtouch::mesh_import {
namespace {

/// Vertices that no triangle needs any more go.
void coarsen(DisplayMesh& mesh, std::size_t most) {
  constexpr float kAnyError = 1.0F;  // of the mesh's size: the number of triangles decides
  const std::size_t vertices = mesh.positions.size() / 3, stride = 3 * sizeof(float);
  const std::vector<unsigned>& all = mesh.indices;
  std::vector<unsigned> fewer(all.size());
  fewer.resize(meshopt_simplify(fewer.data(), all.data(), all.size(), mesh.positions.data(), vertices, stride, 3 * most, kAnyError));
  if (fewer.size() > 6 * most) {  // its topology does not let it: then without regard to that
    fewer.resize(all.size());
    fewer.resize(meshopt_simplifySloppy(fewer.data(), all.data(), all.size(), mesh.positions.data(), vertices, stride, 3 * most, kAnyError));
  }
  std::vector<float> used(mesh.positions.size());
  used.resize(3 * meshopt_optimizeVertexFetch(used.data(), fewer.data(), fewer.size(), mesh.positions.data(), vertices, stride));
  mesh.positions = std::move(used), mesh.indices = std::move(fewer);
}

}  // namespace

DisplayMesh read_display_mesh(const scene::MeshSpec& spec, double voxel_size_m, std::size_t most_triangles) {
  const mesh::TriangleMesh read =
      mesh::import_mesh(spec.path, {.scale = spec.scale, .pose = spec.pose, .voxel_size_m = voxel_size_m}, mesh_process()).mesh;
  DisplayMesh mesh{{}, {}, read.triangles.size()};
  for (const Vec3& v : read.vertices)
    for (const double x : {v.x(), v.y(), v.z()}) mesh.positions.push_back(static_cast<float>(x));
  for (const auto& triangle : read.triangles) mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
  if (mesh.triangles() > most_triangles) coarsen(mesh, most_triangles);
  return mesh;
}

std::string what_is_left_out(const scene::MeshSpec& spec, const DisplayMesh& mesh) {
  if (mesh.triangles() >= mesh.in_file) return {};
  return fmt::format("{} is drawn with {} of its {} triangles; it is felt with all.", spec.path.filename().string(), mesh.triangles(),
                     mesh.in_file);
}

}  // namespace voxtouch::mesh_import
