#include "core/effects/effect_kind.hpp"
#include "core/mesh/mesh_bytes.hpp"
#include "core/rendering/builders_digest.hpp"
#include "core/rendering/built_parts.hpp"
#include "core/scene/mesh_parts.hpp"
#include "core/types/stored_bytes.hpp"

namespace voxtouch::rendering {
namespace {

/// What a mesh's file holds now, where that is what the scene was read with; else nothing.
std::string content_of(const scene::Scene& scene, const std::filesystem::path& path,
                       const SceneStore& store) {
  const auto read = scene.mesh_hashes.find(path);
  if (read == scene.mesh_hashes.end())
    return {};
  const std::string bytes = mesh::read_mesh_bytes(path);
  if (scene::hash_of_mesh(path, bytes) != read->second)
    return {};  // the build says it
  std::string digests;
  scene::for_each_mesh_part(path, bytes,
                            [&](std::string_view part) { digests += store.digest(part); });
  return digests;
}

bool add_mesh(const scene::Scene& scene, const scene::MeshSpec& spec, const SceneStore& store,
              ByteWriter& out) {
  const std::string content = content_of(scene, spec.path, store);
  out(spec.path.filename().string());  // sentences name it, and its ending is the format
  out(content), out(spec.scale), out(spec.pose.position), out(spec.pose.orientation.coeffs()),
      out(spec.object);
  return !content.empty();
}

}  // namespace

std::string recipe_of(const PartsRequest& request, const SceneStore& store) {
  const scene::Scene& scene = request.scene;
  const effects::EffectNeeds needs = effects::needs_of(scene.effects);
  ByteWriter out;
  out(std::string(builders_digest()));
  out(scene.voxel_size_m), out(scene.grid_origin), out(scene.shell),
      out(request.choices.shell_voxel_m), out(request.choices.field_depth_voxels);
  // A field is built for the model `field` alone, and for a virtual tool open parts are walls in
  // it.
  out(request.model == contact::ContactModelKind::kField), out(scene.virtual_tool());
  out(needs.body), out(needs.proximity_m), out(needs.smoothing_m), out(needs.lever_m);
  for (const scene::ObjectSpec& object : scene.objects)
    out(object.name), out(object.grid_origin);
  bool all_known = add_mesh(scene, scene.dynamic_mesh, store, out);
  for (const scene::MeshSpec& spec : scene.static_meshes)
    all_known = add_mesh(scene, spec, store, out) && all_known;
  return all_known ? out.take() : std::string();
}

}  // namespace voxtouch::rendering
