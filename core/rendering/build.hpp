#pragma once
/// Builds a scene for rendering: import, voxmap, pointshell, contact renderer, and the plan that
/// describes them.
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/mesh/import.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/proximity_field.hpp"
#include "core/rendering/scene_renderer.hpp"
#include "core/scene/scene.hpp"
#include "core/types/parallel.hpp"

namespace voxtouch::rendering {

/// Resources of effects in addition to the contact. Each exists only if an effect needs it.
struct EffectGround {
  std::optional<ProximityField> proximity;
  ToolPoints tool;
  std::optional<effects::BodyShape> body;  ///< of a dynamic object with its own motion
  std::unique_ptr<ExactBodies> bodies;     ///< of a virtual tool
  double virtual_tool_lever_m = 0.0;       ///< with `bodies`, above 0
};

/// All data of one built scene. It must not move, since the renderer refers to it.
class BuiltScene {
 public:
  /// Called by `build_scene`.
  BuiltScene(std::vector<std::unique_ptr<StaticObject>> objects,
             std::vector<effects::EffectSpec> effects, EffectGround ground, Plan plan,
             double largest_shell_gap_m);
  BuiltScene(const BuiltScene&) = delete;
  BuiltScene& operator=(const BuiltScene&) = delete;

  /// Contact and effects: the renderer of the ring.
  SceneRenderer& scene_renderer() noexcept { return scene_; }
  /// Contact with the first object only.
  ObjectContacts& contacts() noexcept { return contacts_; }  ///< contact only, with all objects
  contact::ContactRenderer& renderer() noexcept { return *contacts_.object(0).renderer; }
  /// Of the first object.
  const voxmap::Voxmap& voxmap() const noexcept { return contacts_.object(0).voxmap; }
  /// Of the first object; null if the contact model uses none.
  const voxmap::DistanceField* field() const noexcept {
    const StaticObject& first = contacts_.object(0);
    return first.field ? &*first.field : nullptr;
  }
  const EffectGround& effect_ground() const noexcept { return ground_; }
  const Plan& plan() const noexcept { return plan_; }
  /// Largest distance between shell points of neighbouring surface voxels [m].
  double largest_shell_gap_m() const noexcept { return largest_shell_gap_m_; }

 private:
  ObjectContacts contacts_;
  EffectGround ground_;
  SceneRenderer scene_;
  Plan plan_;
  double largest_shell_gap_m_;
};

/// Called with a short sentence at the start of each step, to report progress.
using Progress = std::function<void(const std::string&)>;

/// Deviations from the scene, for comparisons, and the reader of the meshes.
struct BuildChoices {
  std::optional<contact::ContactModelKind> model = {};
  std::optional<contact::PointWeights> weights =
      {};  ///< throws std::invalid_argument if the model does not support these weights
  std::optional<double> shell_voxel_m =
      {};  ///< voxel edge for the pointshell, instead of the scene's
  /// A field with depth down to this [voxels] instead of the default of DistanceFieldOptions. It is
  /// bit-identical down to this depth and takes less time. For a tool that goes no deeper.
  std::optional<double> field_depth_voxels = {};
  /// Programs pass a reader that isolates the process from broken files (nodes/mesh_import).
  mesh::TriangleReader read = mesh::read_triangles;
};

/// Reads the meshes of the scene and builds what it needs. Throws MeshError, VoxelBudgetError and
/// std::invalid_argument, each with a sentence.
/// std::invalid_argument is also thrown for penalty forces with `field` if no static mesh has an
/// interior. The same holds for effects that need distances if no static mesh is closed, and for a
/// lever shorter than the tool.
std::unique_ptr<BuiltScene> build_scene(const scene::Scene& scene, const ParallelFor& parallel_for,
                                        const BuildChoices& choices = {},
                                        const Progress& progress = {});

}  // namespace voxtouch::rendering
