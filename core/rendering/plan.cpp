#include "core/rendering/plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/contact/contact_renderer.hpp"
#include "core/contact/limits.hpp"
#include "core/coupling/coupling_spec.hpp"
#include "core/exact/limits.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::rendering {
namespace {

/// In a body of this thickness the force grows with depth down to ten voxels.
constexpr double kThickVoxels = 25.0;

std::string counted(std::uint64_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

std::string law_sentence(const coupling::CouplingSpec& c) {
  if (c.kind == "shaping_filter")
    return fmt::format(
        "Coupling: shaping filter, w0/(2 pi) = {:g} Hz, damping ratio {:g}, gain {:g}, delay "
        "{:.3g} ms.",
        c.cutoff_hz, c.damping_ratio, c.gain, 1e3 * coupling::lag_s(c));
  if (c.kind == "spring_damper")
    return fmt::format("Coupling: spring-damper, {:g} N/m and {:g} Ns/m to a massless object.",
                       c.stiffness_n_per_m, c.damping_ns_per_m);
  return "Coupling: none. The contact force is the command.";
}

std::string coupling_sentence(const coupling::CouplingSpec& c) {
  std::string text = law_sentence(c);
  if (std::isfinite(c.stiffness_cap_n_per_m))
    text += fmt::format(" Contact stiffness limited to {:g} N/m.", c.stiffness_cap_n_per_m);
  if (std::isfinite(c.stiffness_cap_nm_per_rad))
    text += fmt::format(" Rotational contact stiffness limited to {:g} Nm/rad.",
                        c.stiffness_cap_nm_per_rad);
  if (c.injected_damping_ns_per_m > 0.0 || c.injected_damping_nms_per_rad > 0.0)
    text += fmt::format(" Damping injected in contact: {:g} Ns/m and {:g} Nms/rad.",
                        c.injected_damping_ns_per_m, c.injected_damping_nms_per_rad);
  return text;
}

std::string design_sentence(const scene::DesignOptions& options) {
  std::string text =
      fmt::format("Coupling: designed for the device at the start; kind {}, ", options.kind);
  if (options.kind == "auto" || options.kind == "shaping_filter")
    text += fmt::format("requested cut-off {:g} Hz, ", options.cutoff_hz);
  text += fmt::format("gain margin {:g}, hand: {}, {}", options.gain_margin,
                      scene::name_of(options.hand),
                      options.released ? "may be released" : "never released");
  if (options.stiffness_cap_n_per_m)
    text += fmt::format(", stiffness limited to {:g} N/m", *options.stiffness_cap_n_per_m);
  if (options.stiffness_cap_nm_per_rad)
    text += fmt::format(", limited to {:g} Nm/rad", *options.stiffness_cap_nm_per_rad);
  if (!options.inject_damping)
    text += ", no injected damping";
  return text + ".";
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string needs_text(const effects::EffectNeeds& needs) {
  std::vector<std::string> parts;
  if (needs.contact)
    parts.push_back("the contact");
  if (needs.twist)
    parts.push_back("the tool's velocity");
  if (needs.orientation)
    parts.push_back("the tool's orientation");
  if (needs.external)
    parts.push_back("a writer outside the ring");
  if (needs.proximity_m > 0.0)
    parts.push_back(fmt::format("distances up to {:g} m", needs.proximity_m));
  return parts.empty() ? "only the tool's position" : joined(parts);
}

std::string bound_text(const effects::EffectBound& bound) {
  std::vector<std::string> parts;
  if (bound.stiffness_n_per_m > 0.0)
    parts.push_back(fmt::format("{:.4g} N/m", bound.stiffness_n_per_m));
  if (bound.stiffness_nm_per_rad > 0.0)
    parts.push_back(fmt::format("{:.4g} Nm/rad", bound.stiffness_nm_per_rad));
  if (bound.damping_ns_per_m > 0.0)
    parts.push_back(fmt::format("{:.4g} Ns/m", bound.damping_ns_per_m));
  if (bound.damping_nms_per_rad > 0.0)
    parts.push_back(fmt::format("{:.4g} Nms/rad", bound.damping_nms_per_rad));
  if (std::isfinite(bound.force_n))
    parts.push_back(fmt::format("{:.4g} N", bound.force_n));
  return parts.empty() ? "" : " At most " + joined(parts) + ".";
}

std::string effect_sentence(const effects::EffectSpec& effect) {
  const std::string title = effect.name == effect.kind->name
                                ? fmt::format("Effect '{}'", effect.name)
                                : fmt::format("Effect '{}' ({})", effect.name, effect.kind->name);
  return fmt::format("{}: {} Needs {}.{}{}", title, effect.kind->summary,
                     needs_text(effect.kind->needs(effect.values)),
                     bound_text(effects::bound_of(effect)),
                     effect.on ? "" : " Switched off at the start.");
}

std::string absent_effects(const scene::Scene& scene) {
  std::vector<std::string> absent;
  for (const effects::EffectKind* kind : effects::effect_kinds())
    if (std::none_of(scene.effects.begin(), scene.effects.end(),
                     [&](const effects::EffectSpec& e) { return e.kind == kind; }))
      absent.emplace_back(kind->name);
  return joined(absent);
}

std::string metres(const Vec3& x) {
  return fmt::format("[{}, {}, {}]", x.x(), x.y(), x.z());
}  // all digits, so that it can be entered again

std::string grid_sentence(const PlacedGrid& grid) {
  const std::string begin =
      fmt::format("Voxel grid of '{}' begins at {} m", grid.object, metres(grid.origin));
  if (grid.given)
    return begin + ", as set in the scene.";
  if (grid.origin == grid.at_multiples)
    return begin + ". Its borders are multiples of the voxel size.";
  return fmt::format(
      "{}: faces along the grid lie far from voxel borders. With borders at multiples of the voxel "
      "size it would be {}.",
      begin, metres(grid.at_multiples));
}

/// For a contact without virtual tool: its model, the fastest motion and the largest stiffness.
void add_penalty_notes(const scene::Scene& scene, Plan& plan) {
  if (scene.contact.body_mass_kg > 0.0)
    plan.built.push_back(
        fmt::format("Contact model '{}', stiffness from the body's mass of {:g} kg: resting on 1/6 "
                    "of its surface it sinks {:g} mm.",
                    scene.contact.model, scene.contact.body_mass_kg, 1e3 * scene::kRestDepthM));
  else
    plan.built.push_back(
        scene.contact.stiffness_n_per_m3 > 0.0
            ? fmt::format("Contact model '{}' with {:g} N/m^3; shell points count by their area.",
                          scene.contact.model, scene.contact.stiffness_n_per_m3)
            : fmt::format("Contact model '{}' with {:g} N/m per shell point.", scene.contact.model,
                          scene.contact.stiffness_n_per_m));
  if (scene.contact.rendering == scene::RenderingKind::kMemoryless)
    plan.built.push_back(
        "Memoryless, as in the paper: a point that has crossed a wall gives no force. A run fails "
        "if the tool's centre is inside a solid.");
  const double unseen_mm = 1e3 * contact::limits::kFastEdges * scene.voxel_size_m;
  plan.built.push_back(fmt::format(
      "Speed limit near the scene: half a voxel per sample, {:.3g} mm ({:.3g} m/s at 1 kHz). A "
      "faster tool may pass a wall; such samples are flagged and the run fails.",
      unseen_mm, unseen_mm));
  plan.built.push_back(
      fmt::format("{} in W, about the tool's origin: at most {:.6g} N/m and {:.6g} Nm/rad from one "
                  "point, {:.6g} N/m and {:.6g} Nm/rad {}.",
                  effects::needs_of(scene.effects).body ? "Stiffness of the grip on the body"
                                                        : "Contact stiffness",
                  plan.contact_n_per_m.one_point, plan.contact_nm_per_rad.one_point,
                  plan.contact_n_per_m.all_points, plan.contact_nm_per_rad.all_points,
                  scene.effects.empty() ? "from all points" : "from all points and effects"));
}

/// The parts built from the meshes.
void add_part_notes(const scene::Scene& scene, const BuildCounts& n, Plan& plan) {
  const std::size_t meshes = scene.static_meshes.size();
  plan.built.push_back(fmt::format(
      "Voxmap of {} ({}) at {:g} m: {}, {}, {}.", counted(meshes, "static mesh", "static meshes"),
      counted(n.static_triangles, "triangle", "triangles"), scene.voxel_size_m,
      counted(n.surface_voxels, "surface voxel", "surface voxels"),
      counted(n.interior_voxels, "interior voxel", "interior voxels"), bytes_text(n.voxmap_bytes)));
  for (const PlacedGrid& grid : n.grids)
    plan.built.push_back(grid_sentence(grid));
  if (n.field_bytes > 0)
    plan.built.push_back(fmt::format(
        "Signed distance field to {:g} mm inside: {} of 4 bytes, {} ({:.3g} bytes per surface or "
        "interior voxel), for the contact model 'field'.",
        1e3 * n.field_depth_m, counted(n.field_nodes, "node", "nodes"), bytes_text(n.field_bytes),
        static_cast<double>(n.field_bytes) /
            static_cast<double>(std::max<std::uint64_t>(1, n.surface_voxels + n.interior_voxels))));
  if (n.proximity_bytes > 0)
    plan.built.push_back(fmt::format(
        "Distances around the static meshes up to {:g} mm, smoothed over {:g} mm: {} of 4 bytes, "
        "{}. Effects look up {} of the tool per frame (at most {:.1f} us). No shell point is "
        "farther than {:.2g} mm from one of these.",
        1e3 * n.proximity_m, 1e3 * n.proximity_smoothing_m,
        counted(n.proximity_nodes, "node", "nodes"), bytes_text(n.proximity_bytes),
        counted(n.tool_points, "point", "points"),
        1e-3 * kNsPerProximityPoint * static_cast<double>(n.tool_points), 1e3 * n.tool_gap_m));
  plan.built.push_back(fmt::format("{} pointshell of the tool's mesh ({}): {}, {} (shell: {}).",
                                   scene.shell == scene::ShellKind::kExact ? "Exact" : "Naive",
                                   counted(n.dynamic_triangles, "triangle", "triangles"),
                                   counted(n.shell_points, "point", "points"),
                                   bytes_text(n.shell_bytes),
                                   scene.shell == scene::ShellKind::kExact ? "exact" : "naive"));
}

void add_build_notes(const scene::Scene& scene, const BuildCounts& n, Plan& plan) {
  add_part_notes(scene, n, plan);
  if (n.virtual_tool_lever_m > 0.0)
    plan.built.push_back(fmt::format(
        "Virtual tool: it stays outside the meshes, and its spring to the hand has the certified "
        "stiffness. Contacts are between {} of the tool and {} of the scene, both simplified "
        "within "
        "{:g} um; the voxel size does not affect them. Rotation counts with a lever of {:g} mm. "
        "The work of a frame is limited; at the limit the tool lags behind the hand. No wall is "
        "passed at any speed.",
        counted(n.virtual_tool_triangles, "triangle", "triangles"), n.virtual_tool_scene_triangles,
        1e6 * exact::limits::kSimplifiedM, 1e3 * n.virtual_tool_lever_m));
  else
    add_penalty_notes(scene, plan);
  plan.built.push_back(scene.design ? design_sentence(*scene.design)
                                    : coupling_sentence(scene.coupling));
  for (const effects::EffectSpec& effect : scene.effects)
    plan.built.push_back(effect_sentence(effect));
  if (const effects::EffectSpec* external = effects::external_of(scene.effects))
    plan.built.push_back(effects::no_certificate_sentence(external->name));
  std::size_t parts = 0;
  for (const scene::MeshSpec& mesh : scene.static_meshes)
    parts += mesh.primitives.size();
  parts += scene.dynamic_mesh.primitives.size();
  if (parts > 0)
    plan.built.push_back(fmt::format("Reference for the validator: {}.",
                                     counted(parts, "closed form", "closed forms")));
}

void report_skipped(const scene::Scene& scene, const BuildCounts& n, Plan& plan) {
  if (n.field_bytes == 0)
    plan.skipped.push_back("Signed distance field: only the contact model 'field' uses it.");
  const effects::EffectNeeds needs = effects::needs_of(scene.effects);
  if (!(needs.proximity_m > 0.0))
    plan.skipped.push_back("Distances outside the surface: no effect uses them.");
  if (!needs.twist)
    plan.skipped.push_back("The tool's velocity: no effect uses it.");
  if (const std::string absent = absent_effects(scene); !absent.empty())
    plan.skipped.push_back(fmt::format("Effects: {}.", absent));
  if (n.interior_voxels == 0)
    plan.skipped.push_back(n.closed ? "Interior: no voxel is completely inside at this voxel size."
                                    : "Interior: a static mesh is open.");
  if (!scene.device.clutch_button)
    plan.skipped.push_back("Clutch: the scene names no button.");
}

void add_virtual_tool_warnings(const BuildCounts& n, Plan& plan) {
  for (const std::string& mesh : n.open_meshes)
    plan.warnings.push_back(
        fmt::format("{}: the mesh is open. It holds a virtual tool from either side. A tool can "
                    "pass around rims and through holes.",
                    mesh));
}

void add_field_warnings(const scene::Scene& scene, const BuildCounts& n, Plan& plan) {
  for (const std::string& mesh : n.open_meshes)
    plan.warnings.push_back(fmt::format(
        "{}: the mesh is open. The contact model 'field' gives no force at its open parts.", mesh));
  if (n.thinnest_m < kThickVoxels * scene.voxel_size_m)
    plan.warnings.push_back(
        fmt::format("{}: the thinnest wall is about {:.3g} mm ({:.3g} voxels; {:g} recommended). "
                    "There the force of 'field' grows only to a depth of {:.3g} mm; a tool pushed "
                    "deeper leaves on the other side.",
                    n.thinnest_mesh, 1e3 * n.thinnest_m, n.thinnest_m / scene.voxel_size_m,
                    kThickVoxels, 0.5e3 * n.thinnest_m));
}

void add_proximity_warnings(const BuildCounts& n, Plan& plan) {
  for (const std::string& mesh : n.open_meshes)
    plan.warnings.push_back(fmt::format(
        "{}: the mesh is open. Effects that use distances ignore its open parts.", mesh));
}

void add_warnings(const scene::Scene& scene, const BuildCounts& n, Plan& plan) {
  plan.warnings = scene.warnings;
  plan.warnings.insert(plan.warnings.end(), n.mesh_warnings.begin(), n.mesh_warnings.end());
  if (n.surface_voxels == 0)
    plan.warnings.push_back("The voxmap is empty: there is nothing to touch.");
  if (n.shell_points == 0)
    plan.warnings.push_back("The pointshell is empty: the tool touches nothing.");
  if (n.virtual_tool_lever_m > 0.0)
    add_virtual_tool_warnings(n, plan);
  else if (n.field_bytes > 0)
    add_field_warnings(scene, n, plan);
  if (n.proximity_bytes > 0)
    add_proximity_warnings(n, plan);
  if (plan.expected_ns_per_frame > 1e6)
    plan.warnings.push_back(fmt::format(
        "A frame that looks up every point takes about {:.1f} ms, longer than a period of 1 ms.",
        plan.expected_ns_per_frame / 1e6));
}

}  // namespace

std::string bytes_text(std::uint64_t bytes) {
  if (bytes < 10'000)
    return fmt::format("{} bytes", bytes);
  if (bytes < 10'000'000)
    return fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1e3);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

StiffnessBounds with_effects(const StiffnessBounds& contact,
                             std::span<const effects::EffectSpec> effects) {
  StiffnessBounds bounds = contact;
  for (const effects::EffectSpec& effect : effects) {
    if (is_spring(contact) && effect.kind->friction != nullptr)
      continue;  // a virtual tool has its own friction, which adds no stiffness
    const effects::EffectBound bound = effects::bound_of(effect);
    if (effect.kind->needs(effect.values).body)
      return {{bound.stiffness_n_per_m, bound.stiffness_n_per_m},
              {bound.stiffness_nm_per_rad, bound.stiffness_nm_per_rad}};
    bounds.translation.all_points += bound.stiffness_n_per_m;
    bounds.rotation.all_points += bound.stiffness_nm_per_rad;
  }
  return bounds;
}

Plan make_plan(const scene::Scene& scene, const BuildCounts& counts) {
  Plan plan;
  plan.scene = scene.name, plan.scene_hash = scene.hash, plan.contact_model = scene.contact.model;
  plan.voxel_size_m = scene.voxel_size_m;
  plan.shell_points = counts.shell_points;
  plan.surface_voxels = counts.surface_voxels, plan.interior_voxels = counts.interior_voxels;
  plan.of_contact_alone = counts.contact;
  plan.tool_reach_m = counts.tool_reach_m / scene.device.position_scale;
  const StiffnessBounds bounds = with_effects(plan.of_contact_alone, scene.effects);
  plan.contact_n_per_m = bounds.translation, plan.contact_nm_per_rad = bounds.rotation;
  plan.bytes = counts.voxmap_bytes + counts.shell_bytes + counts.field_bytes +
               counts.proximity_bytes + counts.virtual_tool_bytes;
  plan.parts = plan_parts(scene, counts);
  for (const PlanPart& part : plan.parts)
    if (part.node == "rendering")
      plan.expected_ns_per_frame += part.expected_ns;
  add_build_notes(scene, counts, plan);
  report_skipped(scene, counts, plan);
  add_warnings(scene, counts, plan);
  return plan;
}

}  // namespace voxtouch::rendering
