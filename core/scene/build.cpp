#include "core/scene/build.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "core/mesh/import.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/scene/contact_parameters.hpp"
#include "core/scene/contact_range.hpp"
#include "core/voxmap/distance_thickness.hpp"
#include "core/voxmap/voxelise.hpp"

namespace voxtouch {
namespace {

ImportedMesh import(const MeshSpec& spec, double voxel_size_m) {
  ImportOptions options;
  options.scale = spec.scale;
  options.pose = spec.pose;
  options.voxel_size_m = voxel_size_m;
  return import_mesh(spec.path, options);
}

void warn(BuildCounts& counts, const MeshSpec& spec, const ImportedMesh& imported) {
  const std::string name = spec.path.filename().string();
  for (const std::string& sentence : imported.warnings) counts.mesh_warnings.push_back(name + ": " + sentence);
  for (const std::string& sentence : imported.report.sentences())
    counts.mesh_warnings.push_back(name + ": " + sentence);
}

void append(TriangleMesh& all, const TriangleMesh& mesh) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles) all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

/// All static meshes as one, in W; `last_triangle`: the number of triangles up to each mesh, it included.
TriangleMesh import_static(const Scene& scene, BuildCounts& counts, std::vector<std::size_t>& last_triangle) {
  TriangleMesh all;
  for (const MeshSpec& spec : scene.static_meshes) {
    const ImportedMesh imported = import(spec, scene.voxel_size_m);
    warn(counts, spec, imported);
    counts.closed = counts.closed && imported.report.closed;
    if (!imported.report.closed) counts.open_meshes.push_back(spec.path.filename().string());
    append(all, imported.mesh);
    last_triangle.push_back(all.triangles.size());
  }
  counts.static_triangles = all.triangles.size();
  return all;
}

/// What is known about the meshes so far belongs to the reason why they do not fit.
template <class Build>
auto with_hints(const BuildCounts& counts, Build&& build) {
  try {
    return build();
  } catch (const VoxelBudgetError& error) {
    std::string text = error.what();
    for (const std::string& hint : counts.mesh_warnings) text += ". " + hint;
    throw VoxelBudgetError(text);
  }
}

/// Only a body with an inside can push by depth.
DistanceField build_field(const Scene& scene, const TriangleMesh& fixed, const std::vector<std::size_t>& last_triangle,
                          const Voxmap& voxmap, const ParallelFor& parallel_for, BuildCounts& counts) {
  DistanceField field =
      with_hints(counts, [&] { return build_distance_field(fixed, voxmap, DistanceFieldOptions{}, parallel_for); });
  if (!field.has_inside())
    throw std::invalid_argument(fmt::format(
        "{}: the contact model 'field' pushes by the depth inside a static mesh, but {}. Close the mesh, use a smaller "
        "voxel_size, or choose the model 'adapted', which needs a surface only.",
        scene.file.string(),
        counts.open_meshes.size() == scene.static_meshes.size()
            ? "no static mesh is closed, so none has an inside"
            : fmt::format("at {:g} m no corner of a voxel lies in one", scene.voxel_size_m)));
  counts.field_bytes = field.bytes();
  counts.field_nodes = field.stored_nodes();
  counts.field_depth_m = field.depth_m();
  const ThinnestWall thinnest = thinnest_wall(fixed, voxmap.grid(), parallel_for);
  const auto mesh = std::upper_bound(last_triangle.begin(), last_triangle.end(), std::size_t{thinnest.triangle});
  counts.thinnest_m = thinnest.thickness_m;
  counts.thinnest_mesh =
      scene.static_meshes[static_cast<std::size_t>(mesh - last_triangle.begin())].path.filename().string();
  return field;
}

/// What `needs` asks for; the shell's points are where the tool is looked at.
EffectGround build_effect_ground(const Scene& scene, const EffectNeeds& needs, const TriangleMesh& fixed,
                                 const Voxmap& voxmap, const Pointshell& shell, const ParallelFor& parallel_for,
                                 BuildCounts& counts) {
  EffectGround ground;
  if (!(needs.proximity_m > 0.0)) return ground;
  if (counts.open_meshes.size() == scene.static_meshes.size())
    throw std::invalid_argument(fmt::format(
        "{}: the effect 'proximity' asks for distances to the static objects, but no static mesh is closed, and only a closed "
        "one has an outside. Close the mesh or leave the effect out.",
        scene.file.string()));
  ground.tool = spread_tool_points(shell);
  if (ground.tool.reach_m > needs.lever_m)
    throw std::invalid_argument(fmt::format(
        "{}: 'lever_m' of the effect 'proximity' is {:g} m, but the tool reaches {:.4g} m from its origin. Say at least that.",
        scene.file.string(), needs.lever_m, ground.tool.reach_m));
  with_hints(counts, [&] {
    ground.proximity.emplace(fixed, voxmap, needs.proximity_m, needs.smoothing_m, parallel_for);
    return true;
  });
  counts.proximity_bytes = ground.proximity->bytes() + ground.tool.points.size() * sizeof(ToolPoint);
  counts.proximity_nodes = ground.proximity->nodes();
  counts.proximity_m = needs.proximity_m, counts.proximity_smoothing_m = ground.proximity->smoothing_m();
  counts.tool_points = ground.tool.points.size(), counts.tool_gap_m = ground.tool.gap_m;
  return ground;
}

std::uint64_t shell_bytes(const Pointshell& shell) {
  return shell.size() * (8 * sizeof(double) + sizeof(std::uint32_t));
}

}  // namespace

BuiltScene::BuiltScene(Voxmap voxmap, std::optional<DistanceField> field, Pointshell shell, ContactModelKind model,
                       const ContactParameters& parameters, std::vector<EffectSpec> effects, EffectGround ground,
                       Plan plan, double largest_shell_gap_m)
    : voxmap_(std::move(voxmap)), field_(std::move(field)), ground_(std::move(ground)),
      renderer_(voxmap_, std::move(shell), model, parameters, this->field()),
      scene_(renderer_, std::move(effects),
             {ground_.proximity ? &*ground_.proximity : nullptr, ground_.tool.points}),
      plan_(std::move(plan)), largest_shell_gap_m_(largest_shell_gap_m) {}

std::unique_ptr<BuiltScene> build_scene(const Scene& scene, const ParallelFor& parallel_for,
                                        const BuildChoices& choices, const Progress& progress) {
  const auto step = [&](const std::string& text) {
    if (progress) progress(text);
  };
  ContactModelKind kind = ContactModelKind::kAdapted;
  if (!choices.model && !parse_contact_model(scene.contact.model, kind))
    throw std::invalid_argument(scene.file.string() + ": there is no contact model '" + scene.contact.model + "'");
  kind = choices.model.value_or(kind);

  BuildCounts counts;
  step("reading the static meshes");
  std::vector<std::size_t> last_triangle;
  const TriangleMesh fixed = import_static(scene, counts, last_triangle);
  step("voxmap of " + std::to_string(fixed.triangles.size()) + " triangles");
  Grid grid = default_grid(fixed, scene.voxel_size_m);
  if (scene.grid_origin) grid.origin = *scene.grid_origin;
  Voxmap voxmap = with_hints(counts, [&] { return voxelise(fixed, grid, parallel_for); });
  counts.surface_voxels = voxmap.surface_count();
  counts.interior_voxels = voxmap.interior_count();
  counts.voxmap_bytes = voxmap.bytes();

  std::optional<DistanceField> field;
  if (kind == ContactModelKind::kField) {
    step("distance field");
    field = build_field(scene, fixed, last_triangle, voxmap, parallel_for, counts);
  }

  step("reading the dynamic mesh");
  const ImportedMesh moving = import(scene.dynamic_mesh, scene.voxel_size_m);
  warn(counts, scene.dynamic_mesh, moving);
  counts.dynamic_triangles = moving.mesh.triangles.size();
  step("pointshell of " + std::to_string(moving.mesh.triangles.size()) + " triangles");
  const Grid shell_grid = default_grid(moving.mesh, choices.shell_voxel_m.value_or(scene.voxel_size_m));
  const std::vector<ShellPoint> points =
      with_hints(counts, [&] { return shell_points(moving.mesh, shell_grid, parallel_for); });
  Pointshell shell =
      scene.shell == ShellKind::kExact ? make_exact_shell(points, shell_grid) : make_naive_shell(points, shell_grid);
  counts.shell_points = shell.size();
  counts.shell_bytes = shell_bytes(shell);
  const ContactParameters parameters = contact_parameters(scene.contact, kind, shell, choices.weights);
  const ContactStiffness contact = contact_stiffness(shell, parameters, field ? field->steepest_gradient() : 1.0);
  counts.contact_n_per_m = contact.translation, counts.contact_nm_per_rad = contact.rotation;
  const EffectNeeds needs = needs_of(scene.effects);
  if (needs.proximity_m > 0.0) step("distances round the static meshes");
  EffectGround ground = build_effect_ground(scene, needs, fixed, voxmap, shell, parallel_for, counts);
  for (const EffectSpec& effect : scene.effects) {
    const EffectBound bound = bound_of(effect);
    counts.contact_n_per_m.all_points += bound.stiffness_n_per_m;
    counts.contact_nm_per_rad.all_points += bound.stiffness_nm_per_rad;
  }
  return std::make_unique<BuiltScene>(std::move(voxmap), std::move(field), std::move(shell), kind, parameters, scene.effects,
                                      std::move(ground), make_plan(scene, counts), largest_gap_m(points));
}

}  // namespace voxtouch
