#include "core/scene/scene_file.hpp"

#include <fmt/core.h>

#include "core/mesh/mesh_bytes.hpp"
#include "core/scene/mesh_parts.hpp"
#include "core/scene/scene_hash.hpp"
#include "core/scene/scene_sections.hpp"
#include "core/scene/text_file.hpp"

namespace voxtouch::scene {
namespace {

std::string hash_of(const std::string& text, const SceneSource& source, const MapReader& map,
                    Scene& scene) {
  SceneHash hash;
  hash.add(text);
  const auto add = [&](const MeshSpec& mesh, std::string_view key) {
    try {
      const std::string bytes = mesh::read_mesh_bytes(mesh.path);
      SceneHash own;
      for_each_mesh_part(mesh.path, bytes,
                         [&](std::string_view part) { hash.add(part), own.add(part); });
      scene.mesh_hashes.emplace(mesh.path, own.hex());
    } catch (const mesh::MeshError& error) {
      source.fail(map.require(key).place, fmt::format("{}.", error.what()));
    }
  };
  for (const MeshSpec& mesh : scene.static_meshes)
    add(mesh, "static");
  add(scene.dynamic_mesh, "dynamic");
  return hash.hex();
}

}  // namespace

Scene parse_scene(const std::string& text, const std::filesystem::path& file) {
  SceneSource source{file, {}};
  if (mesh::names_mesh(file))
    source.fail({1, 1},
                "This is a mesh, not a YAML scene file. `voxtouch new MESH` writes a scene.");
  const YamlNode root = parse_yaml(text, file);
  if (root.kind == YamlNode::Kind::kNull)
    source.fail({1, 1},
                "The scene is empty. Required keys: scene, voxel_size, static, dynamic, contact.");
  const MapReader map(source, root, "scene file", keys::scene);
  Scene scene;
  scene.file = file;
  map.read("scene", scene.name);
  map.read("voxel_size", scene.voxel_size_m);
  scene.dynamic_mesh = read_dynamic_mesh(source, map.inner("dynamic"), scene.shell);
  scene.contact = read_contact(source, map.inner("contact"));
  if (map.has("tool"))
    map.inner("tool").read("lever_m", scene.lever_m);
  read_static(source, map.require("static"), scene);
  if (const YamlNode* node = map.find("effects"))
    scene.effects = read_effects(source, *node, scene);
  follow_body_mass(map.inner("contact"), scene);
  if (const YamlNode* node = map.find("coupling"))
    scene.coupling = read_coupling(source, *node, scene.design);
  if (map.has("device"))
    scene.device = read_device(map.inner("device"));
  if (const YamlNode* node = map.find("motions"))
    scene.motions = read_motions(source, *node);
  check_virtual_tool(source, map, scene);
  scene.hash = hash_of(text, source, map, scene);
  scene.warnings = std::move(source.warnings);
  return scene;
}

Scene load_scene(const std::filesystem::path& file) {
  return parse_scene(read_text_file(file, "scene"), file);
}

}  // namespace voxtouch::scene
