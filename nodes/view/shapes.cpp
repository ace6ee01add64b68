#include "nodes/view/shapes.hpp"

#include <vector>

#include <nlohmann/json.hpp>

#include "nodes/mesh_import/display_mesh.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;

json to_json(const std::vector<float>& positions) {
  json all = json::array();
  for (const float x : positions)
    all.push_back(rounded(static_cast<double>(x)));
  return all;
}

}  // namespace

json shapes_of(const scene::Scene& scene, const std::atomic<bool>& stop) {
  json meshes = json::array(), notes = json::array();
  const std::vector<mesh_import::DisplayMesh> all = mesh_import::read_display_meshes(scene, stop);
  for (std::size_t n = 0; n < all.size(); ++n) {
    const mesh_import::DisplayMesh& mesh = all[n];
    if (!mesh.note.empty())
      notes.push_back(mesh.note);
    if (mesh.triangles() == 0)
      continue;
    const bool is_static = n < scene.static_meshes.size();
    const scene::MeshSpec& spec = is_static ? scene.static_meshes[n] : scene.dynamic_mesh;
    meshes.push_back({{"name", spec.path.filename().string()},
                      {"role", is_static ? "static" : "dynamic"},
                      {"object", spec.object},
                      {"positions", to_json(mesh.positions)},
                      {"indices", mesh.indices},
                      {"triangles", mesh.in_file},
                      {"shown", mesh.triangles()}});
  }
  return {{"meshes", meshes}, {"notes", notes}};
}

}  // namespace voxtouch::view
