#include "core/scene/scene_sections.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/effects/body.hpp"

namespace voxtouch::scene {
namespace {

Primitive read_part(const SceneSource& source, const YamlNode& node) {
  const MapReader part(source, node, "parts", keys::part);
  if (node.entries.size() != 1)
    source.fail(node.place, "A part is exactly one of: sphere, box, cylinder.");
  if (part.has("sphere")) {
    const MapReader map = part.inner("sphere");
    SpherePrimitive sphere;
    map.read("centre", sphere.centre);
    map.read("radius", sphere.radius_m);
    return sphere;
  }
  if (part.has("box")) {
    const MapReader map = part.inner("box");
    return BoxPrimitive{read_pose(map), map.get<Vec3>("size")};
  }
  const MapReader map = part.inner("cylinder");
  return CylinderPrimitive{read_pose(map), map.get<double>("radius"), map.get<double>("length")};
}

std::filesystem::path read_mesh_path(const SceneSource& source, const YamlNode& node) {
  const std::filesystem::path given = read_text(source, node, "mesh");
  std::error_code fault;
  auto path =
      std::filesystem::absolute(source.file.parent_path() / given, fault).lexically_normal();
  const bool there = !fault && std::filesystem::is_regular_file(path, fault);
  if (fault == std::errc::permission_denied)
    source.fail(node.place,
                fmt::format("Cannot access mesh file '{}'. Check the permissions of its folders.",
                            given.string()));
  if (!there)
    source.fail(node.place,
                fmt::format("Mesh file '{}' not found (relative to the scene file's folder).",
                            given.string()));
  return path;
}

void check_name(const SceneSource& source, const YamlEntry& entry) {
  if (const std::string fault = fault_of_name(entry.key); !fault.empty())
    source.fail(entry.key_place, fmt::format("The name of a motion {}.", fault));
}

ButtonPress read_press(const SceneSource& source, const YamlNode& node) {
  const MapReader map(source, node, "press", keys::press);
  ButtonPress press;
  map.read("button", press.button);
  map.read("from_s", press.from_s);
  map.read("to_s", press.to_s);
  if (!(press.to_s > press.from_s))
    source.fail(map.place_of("to_s"), "'to_s' must be greater than 'from_s'.");
  return press;
}

void read_turn(const SceneSource& source, const MapReader& map, MotionRotation& turn) {
  map.read("axis", turn.axis);
  map.read("angle_rad", turn.angle_rad);
  map.read("from_s", turn.from_s);
  map.read("to_s", turn.to_s);
  const double norm = turn.axis.stableNorm();
  if (!(norm > 1e-9))
    source.fail(map.place_of("axis"), "'axis' is the zero vector; the rotation needs a direction.");
  turn.axis /= norm;
  if (!(turn.to_s > turn.from_s))
    source.fail(map.place_of("to_s"), "'to_s' must be greater than 'from_s'.");
}

void read_circle(const SceneSource& source, const MapReader& map, Motion& motion) {
  map.read("centre", motion.circle_centre);
  map.read("axis", motion.circle_axis);
  const double norm = motion.circle_axis.stableNorm();
  if (!(norm > 1e-9))
    source.fail(map.place_of("axis"), "'axis' is the zero vector; the circle needs a direction.");
  motion.circle_axis /= norm;
  const Vec3 offset = motion.path.back() - *motion.circle_centre;
  if (!(motion.circle_axis.cross(offset).norm() > 1e-9))
    source.fail(map.place_of("centre"),
                "The path's last point is on the circle's axis: the radius is 0.");
}

}  // namespace

Pose read_pose(const MapReader& map) {
  Pose pose;
  map.read("position", pose.position);
  map.read("orientation", pose.orientation);
  return pose;
}

MeshSpec read_mesh(const SceneSource& source, const MapReader& map) {
  MeshSpec mesh;
  mesh.path = read_mesh_path(source, map.require("mesh"));
  map.read("scale", mesh.scale);
  mesh.pose = read_pose(map);
  for (const YamlNode& part : map.list("parts"))
    mesh.primitives.push_back(read_part(source, part));
  return mesh;
}

Motion read_motion(const SceneSource& source, const YamlNode& node, std::string_view what,
                   bool by_hand) {
  const MapReader map(source, node, what, by_hand ? keys::motion : keys::object_motion);
  Motion motion;
  for (const YamlNode& point : map.list("path"))
    motion.path.push_back(read_vec3(source, point, "path"));
  if (motion.path.empty())
    source.fail(map.require("path").place, "'path' needs at least one point.");
  map.read("speed_m_per_s", motion.speed_m_per_s);
  map.read("hold_s", motion.hold_s);
  if (map.has("repeat_from"))
    map.refuse("circle", "excludes 'repeat_from'. Use one of them.");
  map.read("repeat_from", motion.repeat_from);
  if (motion.repeat_from && *motion.repeat_from >= motion.path.size() - 1)
    source.fail(
        map.require("repeat_from").place,
        fmt::format("'repeat_from' is {}; it must be below {}, the last point of the path (points "
                    "count from 0).",
                    *motion.repeat_from, motion.path.size() - 1));
  if (map.has("circle"))
    read_circle(source, map.inner("circle"), motion);
  if (!by_hand)
    return motion;
  map.read("orientation", motion.orientation);
  if (map.has("turn"))
    read_turn(source, map.inner("turn"), motion.turn);
  for (const YamlNode& press : map.list("press"))
    motion.press.push_back(read_press(source, press));
  return motion;
}

MeshSpec read_dynamic_mesh(const SceneSource& source, const MapReader& map, ShellKind& shell) {
  if (map.has("shell"))
    shell = map.choice("shell") == 0 ? ShellKind::kExact : ShellKind::kNaive;
  return read_mesh(source, map);
}

namespace {

/// In a scene without `rendering`, a stiffness requests penalty forces.
bool has_virtual_tool(const MapReader& map) {
  if (map.has("rendering"))
    return map.choice("rendering") == 0;
  const YamlNode* const model = map.find("model");
  return model && model->text == keys::kModelByArea && !map.has("stiffness_n_per_m") &&
         !map.has("stiffness_n_per_m3");
}

/// No stiffness: the spring displays what the coupling is certified for.
ContactSpec read_virtual_tool(const SceneSource& source, const MapReader& map) {
  ContactSpec contact;
  contact.model = "field", contact.rendering = RenderingKind::kVirtualTool;
  if (map.has("model"))
    map.read("model", contact.model);
  if (contact.model != "field")
    source.fail(
        map.place_of("model"),
        fmt::format("'rendering: virtual_tool' requires model: field, not {}.", contact.model));
  for (const auto key : {"stiffness_n_per_m", "stiffness_n_per_m3"})
    map.refuse(key,
               "is not allowed with 'rendering: virtual_tool', which displays the coupling's "
               "certified stiffness.");
  return contact;
}

}  // namespace

ContactSpec read_contact(const SceneSource& source, const MapReader& map) {
  if (const YamlNode* model = map.find("model"); model && model->text == "clustered")
    source.fail(model->place,
                "Contact model 'clustered' is removed. Use 'model: field' (open static meshes: "
                "'model: adapted') with the same stiffness_n_per_m3.");
  if (has_virtual_tool(map))
    return read_virtual_tool(source, map);
  ContactSpec contact;
  map.read("model", contact.model);
  if (map.has("rendering") && map.choice("rendering") == 2)
    contact.rendering = RenderingKind::kMemoryless;
  const bool by_area_only = contact.model == keys::kModelByArea;
  const bool by_area = map.has("stiffness_n_per_m3");
  if (by_area_only)
    map.refuse("stiffness_n_per_m",
               fmt::format("is per shell point; '{}' has area weights. Use stiffness_n_per_m3.",
                           contact.model));
  if (by_area && map.has("stiffness_n_per_m"))
    source.fail(map.place_of("stiffness_n_per_m3"),
                "'stiffness_n_per_m' (per shell point) and 'stiffness_n_per_m3' (per area) exclude "
                "each other. Use one of them.");
  if (by_area_only || by_area)
    contact.stiffness_n_per_m3 = map.get<double>("stiffness_n_per_m3");
  else
    contact.stiffness_n_per_m = map.get<double>("stiffness_n_per_m");
  return contact;
}

void follow_body_mass(const MapReader& contact, Scene& scene) {
  if (!scene.virtual_tool() || contact.has("rendering"))
    return;
  const auto body =
      std::find_if(scene.effects.begin(), scene.effects.end(),
                   [](const effects::EffectSpec& e) { return e.kind->needs(e.values).body; });
  if (body == scene.effects.end())
    return;
  scene.contact.rendering = RenderingKind::kPenalty;
  scene.contact.body_mass_kg = effects::body_parameters(body->values).mass_kg;
  for (ObjectSpec& object : scene.objects)
    object.contact = scene.contact;
}

void check_virtual_tool(SceneSource& source, const MapReader& map, const Scene& scene) {
  if (!scene.virtual_tool()) {
    if (scene.lever_m)
      source.warn(map.place_of("tool"), "'lever_m' is used by 'rendering: virtual_tool' only.");
    return;
  }
  if (const MapReader contact = map.inner("contact");
      !scene.design && !std::isfinite(scene.coupling.stiffness_cap_n_per_m))
    source.fail(contact.place_of(contact.has("rendering") ? "rendering" : "model"),
                "'rendering: virtual_tool' needs the coupling's stiffness. Use coupling: {design: "
                "auto}, or set its stiffness_cap_n_per_m.");
  if (effects::needs_of(scene.effects).body)
    source.fail(
        map.place_of("effects"),
        "Effect 'body' has its own contact and is not allowed with 'rendering: virtual_tool'.");
}

WorkspaceMapping read_device(const MapReader& map) {
  WorkspaceMapping device;
  map.read("position_scale", device.position_scale);
  map.read("force_scale", device.force_scale);
  if (map.has("pose"))
    device.pose_WD = read_pose(map.inner("pose"));
  if (map.has("tool"))
    device.pose_PT = read_pose(map.inner("tool"));
  map.read("clutch_button", device.clutch_button);
  return device;
}

std::map<std::string, Motion> read_motions(SceneSource& source, const YamlNode& node) {
  if (node.kind != YamlNode::Kind::kMap)
    source.fail(node.place, fmt::format("'motions' must be a map of names to motions, but is {}.",
                                        describe(node)));
  std::map<std::string, Motion> motions;
  for (const YamlEntry& entry : node.entries) {
    check_name(source, entry);
    motions.emplace(entry.key, read_motion(source, entry.value, entry.key, true));
  }
  return motions;
}

}  // namespace voxtouch::scene
