#include "core/scene/build.hpp"

#include <stdexcept>

#include "core/mesh/import.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/scene/contact_parameters.hpp"
#include "core/scene/contact_range.hpp"
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

/// All static meshes as one, in W.
TriangleMesh import_static(const Scene& scene, BuildCounts& counts) {
  TriangleMesh all;
  for (const MeshSpec& spec : scene.static_meshes) {
    const ImportedMesh imported = import(spec, scene.voxel_size_m);
    warn(counts, spec, imported);
    counts.closed = counts.closed && imported.report.closed;
    append(all, imported.mesh);
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

std::uint64_t shell_bytes(const Pointshell& shell) {
  return shell.size() * (8 * sizeof(double) + sizeof(std::uint32_t));
}

}  // namespace

BuiltScene::BuiltScene(Voxmap voxmap, Pointshell shell, ContactModelKind model, const ContactParameters& parameters,
                       std::vector<EffectSpec> effects, Plan plan, double largest_shell_gap_m)
    : voxmap_(std::move(voxmap)), renderer_(voxmap_, std::move(shell), model, parameters),
      scene_(renderer_, std::move(effects)), plan_(std::move(plan)), largest_shell_gap_m_(largest_shell_gap_m) {}

std::unique_ptr<BuiltScene> build_scene(const Scene& scene, const ParallelFor& parallel_for,
                                        std::optional<ContactModelKind> model, const Progress& progress) {
  const auto step = [&](const std::string& text) {
    if (progress) progress(text);
  };
  ContactModelKind kind = ContactModelKind::kAdapted;
  if (!model && !parse_contact_model(scene.contact.model, kind))
    throw std::invalid_argument(scene.file.string() + ": there is no contact model '" + scene.contact.model + "'");
  kind = model.value_or(kind);

  BuildCounts counts;
  step("reading the static meshes");
  const TriangleMesh fixed = import_static(scene, counts);
  step("voxmap of " + std::to_string(fixed.triangles.size()) + " triangles");
  Grid grid = default_grid(fixed, scene.voxel_size_m);
  if (scene.grid_origin) grid.origin = *scene.grid_origin;
  Voxmap voxmap = with_hints(counts, [&] { return voxelise(fixed, grid, parallel_for); });
  counts.surface_voxels = voxmap.surface_count();
  counts.interior_voxels = voxmap.interior_count();
  counts.voxmap_bytes = voxmap.bytes();

  step("reading the dynamic mesh");
  const ImportedMesh moving = import(scene.dynamic_mesh, scene.voxel_size_m);
  warn(counts, scene.dynamic_mesh, moving);
  counts.dynamic_triangles = moving.mesh.triangles.size();
  step("pointshell of " + std::to_string(moving.mesh.triangles.size()) + " triangles");
  const Grid shell_grid = default_grid(moving.mesh, scene.voxel_size_m);
  const std::vector<ShellPoint> points =
      with_hints(counts, [&] { return shell_points(moving.mesh, shell_grid, parallel_for); });
  Pointshell shell =
      scene.shell == ShellKind::kExact ? make_exact_shell(points, shell_grid) : make_naive_shell(points, shell_grid);
  counts.shell_points = shell.size();
  counts.shell_bytes = shell_bytes(shell);
  const ContactParameters parameters = contact_parameters(scene.contact, kind, shell);
  const ContactStiffness contact = contact_stiffness(shell, parameters);
  counts.contact_n_per_m = contact.translation, counts.contact_nm_per_rad = contact.rotation;
  for (const EffectSpec& effect : scene.effects) {
    const EffectBound bound = bound_of(effect);
    counts.contact_n_per_m.all_points += bound.stiffness_n_per_m;
    counts.contact_nm_per_rad.all_points += bound.stiffness_nm_per_rad;
  }
  return std::make_unique<BuiltScene>(std::move(voxmap), std::move(shell), kind, parameters, scene.effects,
                                      make_plan(scene, counts), largest_gap_m(points));
}

}  // namespace voxtouch
