#pragma once
/// From a scene to something that renders: import, voxmap, pointshell, contact renderer, and the
/// plan that describes them.
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

/// What effects look up in addition to the contact; nothing of it is there unless one asks.
struct EffectGround {
  std::optional<ProximityField> proximity;
  ToolPoints tool;
  std::optional<effects::BodyShape> body;      ///< of the dynamic object, where it moves by itself
  std::unique_ptr<WallWatch> watch;            ///< where a virtual tool might pass a wall
  std::unique_ptr<ExactBodies> bodies;         ///< where a virtual tool meets triangles
  std::optional<double> virtual_tool_lever_m;  ///< where the scene has one; 0: the tool's reach
};

/// Everything of one scene in memory. Stays where it is: the renderer points into it.
class BuiltScene {
 public:
  /// For `build_scene`.
  BuiltScene(std::unique_ptr<ToolBody> tool_body,
             std::vector<std::unique_ptr<StaticObject>> objects,
             std::vector<effects::EffectSpec> effects, EffectGround ground, Plan plan,
             double largest_shell_gap_m);
  BuiltScene(const BuiltScene&) = delete;
  BuiltScene& operator=(const BuiltScene&) = delete;

  SceneRenderer& scene_renderer() noexcept {
    return scene_;
  }  ///< contact and effects: what the ring runs
  ObjectContacts& contacts() noexcept { return contacts_; }  ///< contact alone, with all objects
  contact::ContactRenderer& renderer() noexcept {
    return *contacts_.object(0).renderer;
  }  ///< contact with the first object alone
  const voxmap::Voxmap& voxmap() const noexcept {
    return contacts_.object(0).voxmap;
  }  ///< of the first object
  /// Of the first object; null where the contact model looks up none.
  const voxmap::DistanceField* field() const noexcept {
    const StaticObject& first = contacts_.object(0);
    return first.field ? &*first.field : nullptr;
  }
  const EffectGround& effect_ground() const noexcept { return ground_; }
  const Plan& plan() const noexcept { return plan_; }
  /// Largest distance between shell points of neighbouring surface voxels [m].
  double largest_shell_gap_m() const noexcept { return largest_shell_gap_m_; }

 private:
  std::unique_ptr<ToolBody> tool_body_;  ///< the objects' edges point into it
  ObjectContacts contacts_;
  EffectGround ground_;
  SceneRenderer scene_;
  Plan plan_;
  double largest_shell_gap_m_;
};

/// Called before each step with a short sentence, for progress.
using Progress = std::function<void(const std::string&)>;

/// What a virtual tool meets: the distances on voxels (core/contact), or the triangles
/// (core/exact).
enum class ToolMeets : std::uint8_t { kVoxels, kTriangles };

/// What may be built otherwise than the scene says, to compare; and who reads the meshes.
struct BuildChoices {
  std::optional<contact::ContactModelKind> model = {};
  std::optional<contact::PointWeights> weights =
      {};  ///< std::invalid_argument where the model does not weigh so
  std::optional<double> shell_voxel_m =
      {};  ///< voxel edge that the pointshell is made with, instead of the scene's
  /// A field that gives depth down to here [voxels] instead of DistanceFieldOptions' own:
  /// bit-identical to this depth for less time. For a tool that is known to go no deeper.
  std::optional<double> field_depth_voxels = {};
  ToolMeets tool_meets = ToolMeets::kVoxels;
  mesh::TriangleReader read = mesh::read_triangles;  ///< programs give one that a broken file
                                                     ///< cannot take with it (nodes/mesh_import)
};

/// Reads the scene's meshes and builds what it calls for, and nothing else. Throws MeshError,
/// VoxelBudgetError and std::invalid_argument, each a sentence; the last also for penalty forces
/// with `field` where no static mesh has an inside, and for effects that ask for distances where no
/// static mesh is closed or for a lever that the tool is longer than.
std::unique_ptr<BuiltScene> build_scene(const scene::Scene& scene, const ParallelFor& parallel_for,
                                        const BuildChoices& choices = {},
                                        const Progress& progress = {});

}  // namespace voxtouch::rendering
