#include "core/scene/scene_sections.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace voxtouch {
namespace {

Pose read_pose_keys(const MapReader& map) {
  Pose pose;
  map.optional("position", pose.position, read_vec3);
  map.optional("orientation", pose.orientation, read_quat);
  return pose;
}

Pose read_pose(const SceneSource& source, const YamlNode& node, std::string_view what) {
  return read_pose_keys(MapReader(source, node, what, {"position", "orientation"}));
}

Primitive read_part(const SceneSource& source, const YamlNode& node) {
  const MapReader part(source, node, "parts", {"sphere", "box", "cylinder"});
  if (node.entries.size() != 1) source.fail(node.place, "A part is exactly one of: sphere, box, cylinder.");
  const auto positive = [&](const MapReader& map, std::string_view key) {
    return read_positive(source, map.require(key), key);
  };
  if (const YamlNode* body = part.find("sphere")) {
    const MapReader map(source, *body, "sphere", {"centre", "radius"});
    SpherePrimitive sphere;
    map.optional("centre", sphere.centre, read_vec3);
    sphere.radius_m = positive(map, "radius");
    return sphere;
  }
  if (const YamlNode* body = part.find("box")) {
    const MapReader map(source, *body, "box", {"size", "position", "orientation"});
    const Vec3 size = read_vec3(source, map.require("size"), "size");
    if (!(size.minCoeff() > 0.0)) source.fail(map.require("size").place, "'size' must be above 0 along each axis.");
    return BoxPrimitive{read_pose_keys(map), size};
  }
  const MapReader map(source, part.require("cylinder"), "cylinder", {"radius", "length", "position", "orientation"});
  return CylinderPrimitive{read_pose_keys(map), positive(map, "radius"), positive(map, "length")};
}

std::filesystem::path read_mesh_path(const SceneSource& source, const YamlNode& node) {
  const std::filesystem::path given = read_text(source, node, "mesh");
  std::error_code fault;
  auto path = std::filesystem::absolute(source.file.parent_path() / given, fault).lexically_normal();
  const bool there = !fault && std::filesystem::is_regular_file(path, fault);
  if (fault == std::errc::permission_denied)
    source.fail(node.place,
                fmt::format("The mesh file '{}' cannot be reached: check the rights on its folders.", given.string()));
  if (!there)
    source.fail(node.place,
                fmt::format("There is no mesh file '{}' (seen from the scene file's folder).", given.string()));
  return path;
}

void check_name(const SceneSource& source, const YamlEntry& entry) {
  if (const std::string fault = fault_of_name(entry.key); !fault.empty())
    source.fail(entry.key_place, fmt::format("The name of a motion {}.", fault));
}

ButtonPress read_press(const SceneSource& source, const YamlNode& node) {
  const MapReader map(source, node, "press", {"button", "from_s", "to_s"});
  ButtonPress press;
  const std::uint64_t button = read_count(source, map.require("button"), "button");
  if (button > 31) source.fail(map.place_of("button"), fmt::format("'button' is {}; buttons count from 0 to 31.", button));
  press.button = static_cast<std::uint32_t>(button);
  press.from_s = read_not_negative(source, map.require("from_s"), "from_s");
  press.to_s = read_positive(source, map.require("to_s"), "to_s");
  if (!(press.to_s > press.from_s)) source.fail(map.place_of("to_s"), "'to_s' must lie after 'from_s'.");
  return press;
}

void read_circle(const SceneSource& source, const YamlNode& node, Motion& motion) {
  const MapReader map(source, node, "circle", {"centre", "axis"});
  motion.circle_centre = read_vec3(source, map.require("centre"), "centre");
  map.optional("axis", motion.circle_axis, read_vec3);
  const double norm = motion.circle_axis.stableNorm();
  if (!(norm > 1e-9)) source.fail(map.place_of("axis"), "'axis' is the zero vector; a circle turns about a direction.");
  motion.circle_axis /= norm;
  const Vec3 offset = motion.path.back() - *motion.circle_centre;
  if (!(motion.circle_axis.cross(offset).norm() > 1e-9))
    source.fail(map.place_of("centre"),
                "The path's last point lies on the circle's axis; the circle would have no radius.");
}

}  // namespace

MeshSpec read_mesh(const SceneSource& source, const MapReader& map) {
  MeshSpec mesh;
  mesh.path = read_mesh_path(source, map.require("mesh"));
  map.optional("scale", mesh.scale, read_positive);
  mesh.pose = read_pose_keys(map);
  if (const YamlNode* parts = map.find("parts"))
    for (const YamlNode& part : read_list(source, *parts, "parts")) mesh.primitives.push_back(read_part(source, part));
  return mesh;
}

Motion read_motion(const SceneSource& source, const YamlNode& node, std::string_view what, bool with_orientation) {
  std::vector<std::string_view> keys{"path", "speed_m_per_s", "hold_s", "repeat_from", "circle"};
  if (with_orientation) keys.insert(keys.end(), {"orientation", "press"});
  const MapReader map(source, node, what, keys);
  Motion motion;
  for (const YamlNode& point : read_list(source, map.require("path"), "path"))
    motion.path.push_back(read_vec3(source, point, "path"));
  if (motion.path.empty()) source.fail(map.require("path").place, "'path' needs at least one point.");
  map.optional("speed_m_per_s", motion.speed_m_per_s, read_positive);
  map.optional("hold_s", motion.hold_s, read_not_negative);
  map.optional("orientation", motion.orientation, read_quat);
  if (const YamlNode* from = map.find("repeat_from")) {
    map.refuse("circle", "does not go with 'repeat_from': the hand either goes back and forth or round.");
    motion.repeat_from = read_count(source, *from, "repeat_from");
    if (*motion.repeat_from >= motion.path.size() - 1)
      source.fail(from->place,
                  fmt::format("'repeat_from' is {}; it must be below {}, the last point of the path (points "
                              "count from 0).",
                              *motion.repeat_from, motion.path.size() - 1));
  }
  if (const YamlNode* circle = map.find("circle")) read_circle(source, *circle, motion);
  if (const YamlNode* press = with_orientation ? map.find("press") : nullptr)
    for (const YamlNode& one : read_list(source, *press, "press")) motion.press.push_back(read_press(source, one));
  return motion;
}

MeshSpec read_dynamic_mesh(SceneSource& source, const YamlNode& node, ShellKind& shell) {
  const MapReader map(source, node, "dynamic", {"mesh", "scale", "shell", "position", "orientation", "parts"});
  if (const YamlNode* kind = map.find("shell"))
    shell = read_choice(source, *kind, "shell", {"exact", "naive"}) == 0 ? ShellKind::kExact : ShellKind::kNaive;
  return read_mesh(source, map);
}

ContactSpec read_contact(SceneSource& source, const YamlNode& node) {
  const MapReader map(source, node, "contact", {"model", "stiffness_n_per_m", "stiffness_n_per_m3"});
  const std::vector<std::string_view> models{"original", "adapted", "clustered", "field"};
  ContactSpec contact;
  bool by_area_only = false;
  if (const YamlNode* model = map.find("model")) {
    const std::size_t choice = read_choice(source, *model, "model", models);
    by_area_only = choice >= 2;
    contact.model = models[choice];
  }
  const YamlNode* by_area = map.find("stiffness_n_per_m3");
  if (by_area_only)
    map.refuse("stiffness_n_per_m", fmt::format("is per shell point; '{}' weighs points by their area and takes "
                                                "stiffness_n_per_m3.",
                                                contact.model));
  if (by_area != nullptr && map.find("stiffness_n_per_m") != nullptr)
    source.fail(map.place_of("stiffness_n_per_m3"),
                "'stiffness_n_per_m' (per shell point) and 'stiffness_n_per_m3' (per area) exclude each "
                "other; give one of them.");
  if (by_area_only || by_area != nullptr) {
    contact.stiffness_n_per_m3 = read_positive(source, map.require("stiffness_n_per_m3"), "stiffness_n_per_m3");
  } else {
    contact.stiffness_n_per_m = read_positive(source, map.require("stiffness_n_per_m"), "stiffness_n_per_m");
  }
  return contact;
}

WorkspaceMapping read_device(SceneSource& source, const YamlNode& node) {
  const MapReader map(source, node, "device", {"position_scale", "force_scale", "pose", "tool", "clutch_button"});
  WorkspaceMapping device;
  map.optional("position_scale", device.position_scale, read_positive);
  map.optional("force_scale", device.force_scale, read_positive);
  map.optional("pose", device.device_in_world, read_pose);
  map.optional("tool", device.tool_offset, read_pose);
  if (const YamlNode* button = map.find("clutch_button")) {
    const std::uint64_t bit = read_count(source, *button, "clutch_button");
    if (bit > 31) source.fail(button->place, fmt::format("'clutch_button' is {}; buttons count from 0 to 31.", bit));
    device.clutch_button = static_cast<std::uint32_t>(bit);
  }
  return device;
}

std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kMap)
    source.fail(node.place,
                fmt::format("'motions' must be a map of names to motions, but here is {}.", describe(node)));
  std::map<std::string, Motion> motions;
  for (const YamlEntry& entry : node.entries) {
    check_name(source, entry);
    motions.emplace(entry.key, read_motion(source, entry.value, entry.key, true));
  }
  return motions;
}

}  // namespace voxtouch
