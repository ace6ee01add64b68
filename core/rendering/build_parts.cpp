#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "core/mesh/mass_properties.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/rendering/built_parts.hpp"
#include "core/rendering/one_solid.hpp"
#include "core/scene/mesh_parts.hpp"
#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/distance_thickness.hpp"
#include "core/voxmap/object_grid.hpp"
#include "core/voxmap/solid_surface.hpp"
#include "core/voxmap/voxelise.hpp"

namespace voxtouch::rendering {
namespace {

/// Imports the mesh that the scene was read with, and refuses a file that has changed since.
mesh::ImportedMesh import(const scene::MeshSpec& spec, const scene::Scene& scene,
                          const mesh::TriangleReader& reader) {
  mesh::ImportOptions options;
  options.scale = spec.scale;
  options.pose = spec.pose;
  options.voxel_size_m = scene.voxel_size_m;
  std::string bytes = mesh::read_mesh_bytes(spec.path);
  const auto read = scene.mesh_hashes.find(spec.path);
  if (read != scene.mesh_hashes.end() && scene::hash_of_mesh(spec.path, bytes) != read->second)
    throw mesh::MeshError("mesh '" + spec.path.string() +
                          "': changed after the scene was read; reload the scene");
  return mesh::import_mesh(spec.path, std::move(bytes), options, reader);
}

void warn(BuildCounts& counts, const scene::MeshSpec& spec, const mesh::ImportedMesh& imported) {
  const std::string name = spec.path.filename().string();
  for (const std::string& sentence : imported.warnings)
    counts.mesh_warnings.push_back(fmt::format("{}: {}", name, sentence));
  for (const std::string& sentence : imported.report.sentences())
    counts.mesh_warnings.push_back(fmt::format("{}: {}", name, sentence));
}

void append(mesh::TriangleMesh& all, const mesh::TriangleMesh& mesh) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles)
    all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
}

/// The meshes of one object combined, in W. `last_triangle`: number of triangles up to and
/// including each mesh.
struct ObjectMesh {
  mesh::TriangleMesh mesh;
  std::vector<const scene::MeshSpec*> specs;
  std::vector<std::size_t> last_triangle;
  std::size_t open = 0;  ///< number of open meshes
};

/// Common inputs of all parts of a scene.
struct BuildContext {
  const scene::Scene& scene;
  const ParallelFor& parallel_for;
  const BuildChoices& choices;
  const Progress& progress;
  contact::ContactModelKind model;
  bool virtual_tool;
  BuildCounts& counts;

  void step(const std::string& text) const {
    if (progress)
      progress(text);
  }
};

ObjectMesh import_object(const BuildContext& context, std::uint32_t object) {
  const scene::Scene& scene = context.scene;
  BuildCounts& counts = context.counts;
  ObjectMesh all;
  for (const scene::MeshSpec& spec : scene.static_meshes) {
    if (spec.object != object)
      continue;
    if (const auto n = &spec - scene.static_meshes.data(); n > 0)
      context.step(fmt::format("reading mesh {} of {}", n + 1, scene.static_meshes.size()));
    const mesh::ImportedMesh imported = import(spec, scene, context.choices.read);
    warn(counts, spec, imported);
    counts.closed = counts.closed && imported.report.closed;
    if (!imported.report.closed)
      counts.open_meshes.push_back(spec.path.filename().string()), ++all.open;
    append(all.mesh, imported.mesh);
    all.specs.push_back(&spec);
    all.last_triangle.push_back(all.mesh.triangles.size());
  }
  counts.static_triangles += all.mesh.triangles.size();
  return all;
}

/// Adds hints about the meshes to the reason why they do not fit.
template <class Build>
auto with_hints(const BuildCounts& counts, Build&& build) {
  try {
    return build();
  } catch (const voxmap::VoxelBudgetError& error) {
    std::string text = error.what();
    for (const std::string& hint : counts.mesh_warnings)
      text += ". " + hint;
    throw voxmap::VoxelBudgetError(text);
  }
}

/// Penalty forces need a body with an interior; a virtual tool is constrained by any surface.
voxmap::DistanceField build_field(const BuildContext& context, const ObjectMesh& fixed,
                                  const voxmap::Voxmap& voxmap) {
  const scene::Scene& scene = context.scene;
  BuildCounts& counts = context.counts;
  const ParallelFor& parallel_for = context.parallel_for;
  voxmap::DistanceFieldOptions options;
  options.depth_voxels = context.choices.field_depth_voxels.value_or(options.depth_voxels);
  const voxmap::ClosedMesh closed(fixed.mesh, voxmap.grid());
  voxmap::DistanceField field = with_hints(
      counts, [&] { return voxmap::build_distance_field(closed, voxmap, options, parallel_for); });
  if (!context.virtual_tool && !field.has_inside())
    throw std::invalid_argument(fmt::format(
        "{}: contact model 'field' needs depth inside a static mesh, but {}. Close the mesh, use a "
        "smaller voxel_size, or rendering: virtual_tool.",
        scene.file.string(),
        fixed.open == fixed.specs.size()
            ? "no static mesh is closed"
            : fmt::format("at {:g} m no voxel corner is inside one", scene.voxel_size_m)));
  counts.field_bytes += field.bytes();
  counts.field_nodes += field.stored_nodes();
  counts.field_depth_m = field.depth_m();
  if (context.virtual_tool)
    return field;
  const voxmap::ThinnestWall thinnest = voxmap::thinnest_wall(closed, voxmap.grid(), parallel_for);
  if (!(thinnest.thickness_m < counts.thinnest_m))
    return field;
  const auto mesh = std::upper_bound(fixed.last_triangle.begin(), fixed.last_triangle.end(),
                                     std::size_t{thinnest.triangle});
  counts.thinnest_m = thinnest.thickness_m;
  counts.thinnest_mesh = fixed.specs[static_cast<std::size_t>(mesh - fixed.last_triangle.begin())]
                             ->path.filename()
                             .string();
  return field;
}

/// For scenes with a body as dynamic object.
effects::BodyShape body_shape(const scene::Scene& scene, const mesh::TriangleMesh& mesh) {
  try {
    const mesh::MassProperties mass = mesh::mass_properties(mesh);
    effects::BodyShape shape{.centre = mass.centre, .inertia_m2 = mass.inertia_m2};
    for (const Vec3& v : mesh.vertices)
      shape.reach_m = std::max(shape.reach_m, v.norm());
    return shape;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format(
        "{}: effect 'body' needs the mass of the dynamic object {}, but {}.", scene.file.string(),
        scene.dynamic_mesh.path.filename().string(), error.what()));
  }
}

/// Surface of the volume that the mesh encloses, in W.
mesh::TriangleMesh surface_of(const BuildContext& context, const mesh::TriangleMesh& mesh) {
  return voxmap::solid_surface(mesh, voxmap::default_grid(mesh, context.scene.voxel_size_m));
}

/// The voxel grid of an object, or of the solid with these `members`, also recorded for the plan.
/// The members of a solid share one grid: the first one specified.
voxmap::Grid place_grid(const BuildContext& context, std::span<const std::size_t> members,
                        const std::string& name, const mesh::TriangleMesh& mesh) {
  const scene::Scene& scene = context.scene;
  const double edge = scene.voxel_size_m;
  const Vec3 at_multiples = voxmap::default_grid(mesh, edge).origin;
  std::optional<Vec3> given;
  for (const std::size_t id : members)
    if (!given)
      given = id == 0 ? scene.grid_origin : scene.objects[id - 1].grid_origin;
  const voxmap::Grid grid =
      given ? voxmap::Grid{*given, edge} : voxmap::object_grid(surface_of(context, mesh), edge);
  context.counts.grids.push_back({name, grid.origin, at_multiples, given.has_value()});
  return grid;
}

/// Resting objects that form one solid.
struct Solid {
  std::vector<std::size_t> members;  ///< their ids, ascending
  ObjectMesh all;                    ///< of all members
};

/// Objects whose surfaces do not change each other do not form a solid.
std::vector<Solid> find_solids(const BuildContext& context, const std::vector<ObjectMesh>& fixed) {
  std::vector<mesh::TriangleMesh> meshes;
  std::vector<bool> rests;
  for (std::size_t id = 0; id < fixed.size(); ++id) {
    meshes.push_back(fixed[id].mesh);
    rests.push_back(id == 0 || !context.scene.objects[id - 1].moves);
  }
  std::vector<Solid> solids;
  for (std::vector<std::size_t>& members :
       solids_of(meshes, rests, voxmap::kSeamVoxels * context.scene.voxel_size_m)) {
    Solid solid{std::move(members), {}};
    std::size_t triangles = 0, vertices = 0;  // of the separate members
    for (const std::size_t id : solid.members) {
      const std::size_t before = solid.all.mesh.triangles.size();
      append(solid.all.mesh, fixed[id].mesh);
      for (std::size_t n = 0; n < fixed[id].specs.size(); ++n) {
        solid.all.specs.push_back(fixed[id].specs[n]);
        solid.all.last_triangle.push_back(before + fixed[id].last_triangle[n]);
      }
      solid.all.open += fixed[id].open;
      const mesh::TriangleMesh alone = surface_of(context, fixed[id].mesh);
      triangles += alone.triangles.size(), vertices += alone.vertices.size();
    }
    const mesh::TriangleMesh together = surface_of(context, solid.all.mesh);
    if (together.triangles.size() != triangles || together.vertices.size() != vertices)
      solids.push_back(std::move(solid));
  }
  return solids;
}

/// Each solid is one body, and so is each other object.
std::unique_ptr<ExactBodies> build_bodies(const BuildContext& context,
                                          const mesh::TriangleMesh& tool,
                                          const std::vector<ObjectMesh>& objects,
                                          const std::vector<Solid>& solids) {
  context.step("features of all meshes");
  std::vector<std::size_t> numbers(objects.size());  // objects without a mesh have no body
  std::size_t numbered = 0;
  for (std::size_t id = 0; id < objects.size(); ++id)
    numbers[id] = objects[id].specs.empty() ? numbered : numbered++;
  std::vector<ExactBodies::Object> bodies;
  std::vector<bool> done(objects.size());
  const auto add = [&](ExactBodies::Object& body, std::size_t id) {
    append(body.mesh, objects[id].mesh);
    body.owners.resize(body.mesh.triangles.size(), static_cast<std::uint32_t>(body.objects.size()));
    body.objects.push_back(numbers[id]);
    done[id] = true;
  };
  for (const Solid& solid : solids)
    for (ExactBodies::Object& body = bodies.emplace_back(); const std::size_t id : solid.members)
      add(body, id);
  for (std::size_t id = 0; id < objects.size(); ++id)
    if (!done[id] && !objects[id].specs.empty())
      add(bodies.emplace_back(), id);
  return std::make_unique<ExactBodies>(tool, bodies, context.scene.voxel_size_m);
}

/// Builds the parts of the dynamic mesh.
void build_tool(const BuildContext& context, const std::vector<ObjectMesh>& objects,
                const std::vector<Solid>& solids, BuiltParts& parts) {
  const scene::Scene& scene = context.scene;
  context.step("reading the dynamic mesh");
  const mesh::ImportedMesh moving = import(scene.dynamic_mesh, scene, context.choices.read);
  warn(context.counts, scene.dynamic_mesh, moving);
  context.counts.dynamic_triangles = moving.mesh.triangles.size();
  context.step("pointshell of " + std::to_string(moving.mesh.triangles.size()) + " triangles");
  const voxmap::Grid grid =
      voxmap::default_grid(moving.mesh, context.choices.shell_voxel_m.value_or(scene.voxel_size_m));
  const std::vector<pointshell::ShellPoint> points = with_hints(context.counts, [&] {
    return pointshell::shell_points(moving.mesh, grid, context.parallel_for);
  });
  parts.largest_gap_m = pointshell::largest_gap_m(points);
  parts.shell = scene.shell == scene::ShellKind::kExact
                    ? pointshell::make_exact_shell(points, grid)
                    : pointshell::make_naive_shell(points, grid);
  context.counts.shell_points = parts.shell.size();
  if (context.virtual_tool)
    parts.bodies = build_bodies(context, moving.mesh, objects, solids);
  if (effects::needs_of(scene.effects).body)
    parts.body = body_shape(scene, moving.mesh);
}

/// The voxels of object `id` in `solid`, whose voxels are `all`: each voxel belongs to one object.
voxmap::Voxmap voxels_in_solid(const BuildContext& context, std::uint32_t id,
                               const std::vector<ObjectMesh>& fixed, const Solid& solid,
                               const voxmap::Voxmap& all) {
  const auto own = [&](std::size_t object) {
    return voxmap::voxelise(fixed[object].mesh, all.grid(), context.parallel_for);
  };
  std::vector<voxmap::Voxmap> before;
  for (const std::size_t member : solid.members)
    if (member < id)
      before.push_back(own(member));
  std::vector<const voxmap::Voxmap*> others;
  for (const voxmap::Voxmap& map : before)
    others.push_back(&map);
  return owned_part(all, own(id), others);
}

/// Builds the voxmap and further data of the contact model. Null for the static scene if it
/// contains no mesh. `solid`: the solid that contains the object; null: none.
std::unique_ptr<StaticObject> build_object(const BuildContext& context, std::uint32_t id,
                                           const std::vector<ObjectMesh>& objects,
                                           const Solid* solid) {
  const scene::Scene& scene = context.scene;
  if (objects[id].specs.empty())
    return nullptr;
  const ObjectMesh& fixed = solid != nullptr ? solid->all : objects[id];
  const std::string name = id == 0 ? "ground" : scene.objects[id - 1].name;
  context.step("voxmap of " + std::to_string(fixed.mesh.triangles.size()) + " triangles");
  const std::vector<std::size_t> members =
      solid != nullptr ? solid->members : std::vector<std::size_t>{id};
  const voxmap::Grid grid = place_grid(context, members, name, fixed.mesh);
  auto object = std::make_unique<StaticObject>(StaticObject{
      .id = id,
      .name = name,
      .voxmap = with_hints(
          context.counts, [&] { return voxmap::voxelise(fixed.mesh, grid, context.parallel_for); }),
      .field = {},
      .solid = solid != nullptr ? std::optional(members.front()) : std::nullopt,
      .moves = id == 0 ? std::nullopt : scene.objects[id - 1].moves,
      .renderer = {}});
  voxmap::Voxmap all;  // of the solid: the distances are computed from it
  if (solid != nullptr) {
    all = std::move(object->voxmap);
    object->voxmap = with_hints(context.counts,
                                [&] { return voxels_in_solid(context, id, objects, *solid, all); });
  }
  context.counts.surface_voxels += object->voxmap.surface_count();
  context.counts.interior_voxels += object->voxmap.interior_count();
  context.counts.voxmap_bytes += object->voxmap.bytes();
  if (context.model == contact::ContactModelKind::kField) {
    context.step("distance field");
    object->field = build_field(context, fixed, solid != nullptr ? all : object->voxmap);
  }
  return object;
}

/// Builds the distances around the static scene that `needs` requires. The shell's points are the
/// query points of the tool.
void build_proximity(const BuildContext& context, const effects::EffectNeeds& needs,
                     const ObjectMesh& fixed, bool in_solid, BuiltParts& parts) {
  const scene::Scene& scene = context.scene;
  BuildCounts& counts = context.counts;
  if (fixed.open == fixed.specs.size())
    throw std::invalid_argument(fmt::format(
        "{}: effect 'proximity' needs distances to closed static meshes of the ground, but {}. "
        "Close them or remove the effect.",
        scene.file.string(),
        fixed.specs.empty() ? "all of them belong to objects" : "none of them is closed"));
  context.step("distances round the static meshes");
  ToolPoints& tool = parts.tool_points = spread_tool_points(parts.shell);
  if (tool.reach_m > needs.lever_m)
    throw std::invalid_argument(fmt::format(
        "{}: 'lever_m' of effect 'proximity' is {:g} m, minimum {:.4g} m (reach of the tool).",
        scene.file.string(), needs.lever_m, tool.reach_m));
  with_hints(counts, [&] {
    const voxmap::Voxmap& first = parts.objects.front()->voxmap;
    const voxmap::Voxmap alone =
        in_solid ? voxmap::voxelise(fixed.mesh, first.grid(), context.parallel_for)
                 : voxmap::Voxmap();
    parts.proximity.emplace(fixed.mesh, in_solid ? alone : first, needs.proximity_m,
                            needs.smoothing_m, context.parallel_for);
    return true;
  });
  counts.proximity_bytes =
      parts.proximity->bytes() + tool.points.size() * sizeof(effects::ToolPoint);
  counts.proximity_nodes = parts.proximity->nodes();
  counts.proximity_m = needs.proximity_m,
  counts.proximity_smoothing_m = parts.proximity->smoothing_m();
  counts.tool_points = tool.points.size(), counts.tool_gap_m = tool.gap_m;
}

}  // namespace

BuiltParts build_parts(const PartsRequest& request, const ParallelFor& parallel_for,
                       const Progress& progress) {
  const scene::Scene& scene = request.scene;
  const effects::EffectNeeds needs = effects::needs_of(scene.effects);
  BuiltParts parts;
  const BuildContext context{scene,         parallel_for,           request.choices, progress,
                             request.model, request.virtual_tool(), parts.counts};
  std::vector<ObjectMesh> fixed;
  for (std::uint32_t id = 0; id <= scene.objects.size(); ++id) {
    context.step(id == 0 ? "reading the static meshes"
                         : "reading the meshes of '" + scene.objects[id - 1].name + "'");
    fixed.push_back(import_object(context, id));
  }
  const std::vector<Solid> solids =
      scene.objects.empty() ? std::vector<Solid>{} : find_solids(context, fixed);
  const auto solid_with = [&](std::size_t id) -> const Solid* {
    const auto found = std::ranges::find_if(solids, [&](const Solid& s) {
      return std::ranges::find(s.members, id) != s.members.end();
    });
    return found == solids.end() ? nullptr : &*found;
  };
  for (std::uint32_t id = 0; id < fixed.size(); ++id) {
    if (auto object = build_object(context, id, fixed, solid_with(id)))
      parts.objects.push_back(std::move(object));
  }
  parts.counts.objects = parts.objects.size();
  build_tool(context, fixed, solids, parts);
  if (needs.proximity_m > 0.0)
    build_proximity(context, needs, fixed.front(), solid_with(0) != nullptr, parts);
  return parts;
}

}  // namespace voxtouch::rendering
