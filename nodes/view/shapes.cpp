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
  for (const float x : positions) all.push_back(rounded(static_cast<double>(x)));
  return all;
}

}  // namespace

json shapes_of(const scene::Scene& scene) {
  json meshes = json::array(), notes = json::array();
  const std::size_t share = kMostTriangles / (scene.static_meshes.size() + 1);
  const auto add = [&](const scene::MeshSpec& spec, const char* role) {
    try {
      const mesh_import::DisplayMesh mesh = mesh_import::read_display_mesh(spec, scene.voxel_size_m, share);
      if (const std::string left_out = what_is_left_out(spec, mesh); !left_out.empty()) notes.push_back(left_out);
      meshes.push_back({{"name", spec.path.filename().string()},
                        {"role", role},
                        {"object", spec.object},
                        {"positions", to_json(mesh.positions)},
                        {"indices", mesh.indices},
                        {"triangles", mesh.in_file},
                        {"shown", mesh.triangles()}});
    } catch (const std::exception& error) {
      notes.push_back(error.what());
    }
  };
  for (const scene::MeshSpec& spec : scene.static_meshes) add(spec, "static");
  add(scene.dynamic_mesh, "dynamic");
  return {{"meshes", meshes}, {"notes", notes}};
}

}  // namespace voxtouch::view
