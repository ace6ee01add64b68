// The `static` section of a scene: meshes, and the objects that some of them make up.
#include <fmt/core.h>

#include <algorithm>

#include "core/scene/object_limit.hpp"
#include "core/scene/scene_sections.hpp"

namespace voxtouch::scene {
namespace {

/// The object's stiffness in the scene's unit, or the scene's.
ContactSpec read_material(const MapReader& map, const ContactSpec& scenes) {
  ContactSpec contact = scenes;
  if (scenes.rendering == RenderingKind::kVirtualTool) {
    for (const auto key : {"stiffness_n_per_m", "stiffness_n_per_m3"})
      map.refuse(key,
                 "is not allowed with 'rendering: virtual_tool', which displays the coupling's "
                 "certified stiffness.");
    return contact;
  }
  const bool by_area = scenes.stiffness_n_per_m3 > 0.0;
  const char* key = by_area ? "stiffness_n_per_m3" : "stiffness_n_per_m";
  map.refuse(by_area ? "stiffness_n_per_m" : "stiffness_n_per_m3",
             fmt::format("has a different unit than the scene's contact; use {}.", key));
  map.read(key, by_area ? contact.stiffness_n_per_m3 : contact.stiffness_n_per_m);
  return contact;
}

std::uint32_t place_of(const Scene& scene, std::string_view name) {
  for (std::size_t n = 0; n < scene.objects.size(); ++n)
    if (scene.objects[n].name == name)
      return static_cast<std::uint32_t>(n + 1);
  return 0;
}

/// A name refers to an object of an entry above; a map makes one.
std::uint32_t read_object(const SceneSource& source, const YamlNode& node, Scene& scene) {
  if (node.kind != YamlNode::Kind::kMap) {
    const std::string name = read_text(source, node, "object");
    const std::uint32_t place = place_of(scene, name);
    if (place == 0)
      source.fail(node.place,
                  fmt::format("Unknown object '{}'. Define it here with object: {{name: {}}}.",
                              name, name));
    return place;
  }
  const MapReader map(source, node, "object", keys::object);
  ObjectSpec object;
  map.read("name", object.name);
  if (object.name == "ground" || place_of(scene, object.name) != 0)
    source.fail(map.place_of("name"), fmt::format("Duplicate object name '{}'.", object.name));
  object.contact = read_material(map, scene.contact);
  if (const YamlNode* moves = map.find("moves"))
    object.moves = read_motion(source, *moves, "moves", false);
  scene.objects.push_back(std::move(object));
  if (scene.objects.size() >= kMaxObjects)
    source.fail(node.place,
                fmt::format("Too many objects, limit {} (including the ground).", kMaxObjects));
  return static_cast<std::uint32_t>(scene.objects.size());
}

}  // namespace

void read_static(SceneSource& source, const YamlNode& node, Scene& scene) {
  for (const YamlNode& item : read_list(source, node, "static")) {
    const MapReader map(source, item, "static", keys::static_mesh);
    MeshSpec mesh = read_mesh(source, map);
    if (const YamlNode* object = map.find("object"))
      mesh.object = read_object(source, *object, scene);
    std::optional<Vec3>& origin =
        mesh.object == 0 ? scene.grid_origin : scene.objects[mesh.object - 1].grid_origin;
    scene.static_meshes.push_back(std::move(mesh));
    if (origin && map.has("origin"))
      source.fail(map.place_of("origin"),
                  "Duplicate 'origin': all meshes of an object (or of the ground) share one grid.");
    map.read("origin", origin);
  }
  if (scene.static_meshes.empty())
    source.fail(node.place, "'static' needs at least one mesh.");
}

}  // namespace voxtouch::scene
