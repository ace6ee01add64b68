#include "nodes/mesh_import/display_mesh.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "nodes/mesh_import/mesh_process.hpp"

namespace voxtouch::mesh_import {
namespace {

/// Removes unused vertices.
void coarsen(DisplayMesh& mesh, std::size_t most) {
  constexpr float kAnyError = 1.0F;  // of the mesh's size: the number of triangles decides
  const std::size_t vertices = mesh.positions.size() / 3, stride = 3 * sizeof(float);
  const std::vector<unsigned>& all = mesh.indices;
  std::vector<unsigned> fewer(all.size());
  fewer.resize(meshopt_simplify(fewer.data(), all.data(), all.size(), mesh.positions.data(),
                                vertices, stride, 3 * most, kAnyError));
  if (fewer.size() > 6 * most) {  // the topology prevents it: ignore the topology
    fewer.resize(all.size());
    fewer.resize(meshopt_simplifySloppy(fewer.data(), all.data(), all.size(), mesh.positions.data(),
                                        vertices, stride, 3 * most, kAnyError));
  }
  std::vector<float> used(mesh.positions.size());
  used.resize(3 * meshopt_optimizeVertexFetch(used.data(), fewer.data(), fewer.size(),
                                              mesh.positions.data(), vertices, stride));
  mesh.positions = std::move(used), mesh.indices = std::move(fewer);
}

DisplayMesh read_whole(const scene::MeshSpec& spec, double voxel_size_m) {
  DisplayMesh mesh;
  try {
    const mesh::TriangleMesh read =
        mesh::import_mesh(spec.path,
                          {.scale = spec.scale, .pose = spec.pose, .voxel_size_m = voxel_size_m},
                          mesh_process())
            .mesh;
    mesh.in_file = read.triangles.size();
    for (const Vec3& v : read.vertices)
      for (const double x : {v.x(), v.y(), v.z()})
        mesh.positions.push_back(static_cast<float>(x));
    for (const auto& triangle : read.triangles)
      mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
  } catch (const std::exception& error) {
    mesh.note = error.what();
  }
  return mesh;
}

}  // namespace

std::vector<std::size_t> counts_of(const std::vector<std::size_t>& counts, std::size_t most) {
  std::vector<std::size_t> order(counts.size()), quotas(counts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t n) { return counts[n]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    quotas[order[k]] = std::min(counts[order[k]], most / (order.size() - k));
    most -= quotas[order[k]];
  }
  return quotas;
}

std::vector<DisplayMesh> read_display_meshes(const scene::Scene& scene,
                                             const std::atomic<bool>& stop) {
  std::vector<const scene::MeshSpec*> specs;
  for (const scene::MeshSpec& spec : scene.static_meshes)
    specs.push_back(&spec);
  specs.push_back(&scene.dynamic_mesh);
  std::vector<DisplayMesh> all;
  std::vector<std::size_t> counts;
  for (const scene::MeshSpec* spec : specs) {
    all.push_back(stop.load() ? DisplayMesh{} : read_whole(*spec, scene.voxel_size_m));
    counts.push_back(all.back().triangles());
  }
  const std::vector<std::size_t> quotas = counts_of(counts, kMaxDrawnTriangles);
  for (std::size_t n = 0; n < all.size() && !stop.load(); ++n) {
    if (counts[n] <= quotas[n])
      continue;
    coarsen(all[n], quotas[n]);
    all[n].note = fmt::format("{} is displayed with {} of {} triangles; contact uses all of them.",
                              specs[n]->path.filename().string(), all[n].triangles(), counts[n]);
  }
  return all;
}

}  // namespace voxtouch::mesh_import
