#include "nodes/view/shapes.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;

struct Triangles {
  std::vector<float> positions;
  std::vector<unsigned> indices;
  std::size_t count() const { return indices.size() / 3; }
};

Triangles read(const scene::MeshSpec& spec, double voxel_size_m) {
  const mesh::TriangleMesh mesh =
      mesh::import_mesh(spec.path, {.scale = spec.scale, .pose = spec.pose, .voxel_size_m = voxel_size_m}, mesh_import::mesh_process())
          .mesh;
  Triangles t;
  for (const Vec3& v : mesh.vertices)
    for (const double x : {v.x(), v.y(), v.z()}) t.positions.push_back(static_cast<float>(x));
  for (const auto& triangle : mesh.triangles) t.indices.insert(t.indices.end(), triangle.begin(), triangle.end());
  return t;
}

/// At most `most` triangles, or nearly so; vertices that no triangle needs any more go.
void coarsen(Triangles& t, std::size_t most) {
  constexpr float kAnyError = 1.0F;  // of the mesh's size: the number of triangles decides
  const std::size_t vertices = t.positions.size() / 3, stride = 3 * sizeof(float);
  std::vector<unsigned> fewer(t.indices.size());
  fewer.resize(meshopt_simplify(fewer.data(), t.indices.data(), t.indices.size(), t.positions.data(), vertices, stride, 3 * most, kAnyError));
  if (fewer.size() > 6 * most) {  // its topology does not let it: then without regard to that
    fewer.resize(t.indices.size());
    fewer.resize(meshopt_simplifySloppy(fewer.data(), t.indices.data(), t.indices.size(), t.positions.data(), vertices, stride, 3 * most, kAnyError));
  }
  std::vector<float> used(t.positions.size());
  used.resize(3 * meshopt_optimizeVertexFetch(used.data(), fewer.data(), fewer.size(), t.positions.data(), vertices, stride));
  t = {std::move(used), std::move(fewer)};
}

json to_json(const std::vector<float>& positions) {
  json all = json::array();
  for (const float x : positions) all.push_back(rounded(static_cast<double>(x)));
  return all;
}

}  // namespace

json shapes_of(const scene::Scene& scene) {
  json meshes = json::array(), notes = json::array();
  const std::size_t share = kMostTriangles / (scene.static_meshes.size() + 1);
  const auto add = [&](const scene::MeshSpec& spec, const char* role) {
    const std::string name = spec.path.filename().string();
    try {
      Triangles t = read(spec, scene.voxel_size_m);
      const std::size_t all = t.count();
      if (all > share) coarsen(t, share);
      if (t.count() < all)
        notes.push_back(fmt::format("{} is drawn with {} of its {} triangles; it is felt with all.", name, t.count(), all));
      meshes.push_back({{"name", name},
                        {"role", role},
                        {"object", spec.object},
                        {"positions", to_json(t.positions)},
                        {"indices", t.indices},
                        {"triangles", all},
                        {"shown", t.count()}});
    } catch (const std::exception& error) {
      notes.push_back(error.what());
    }
  };
  for (const scene::MeshSpec& spec : scene.static_meshes) add(spec, "static");
  add(scene.dynamic_mesh, "dynamic");
  return {{"meshes", meshes}, {"notes", notes}};
}

}  // namespace voxtouch::view
