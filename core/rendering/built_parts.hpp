#pragma once
/// What is made of a scene's meshes: all that takes time, apart from all that the rest of the scene
/// says.
#include <memory>
#include <optional>
#include <vector>

#include "core/effects/rigid_body.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/proximity_field.hpp"
#include "core/rendering/wall_watch.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// What of a scene and its choices decides how its parts are built.
struct PartsRequest {
  const scene::Scene& scene;
  const BuildChoices& choices;
  contact::ContactModelKind model;  ///< the one chosen, else the scene's

  /// Rendered through another model, it is a scene without one.
  bool virtual_tool() const noexcept {
    return scene.virtual_tool() && model == contact::ContactModelKind::kField;
  }
  bool meets_triangles() const noexcept {
    return virtual_tool() && choices.tool_meets == ToolMeets::kTriangles;
  }
};

struct BuiltParts {
  std::vector<std::unique_ptr<StaticObject>>
      objects;  ///< without their renderers and edges' queries; those with meshes, in the order of
                ///< their ids
  pointshell::Pointshell shell;
  double largest_gap_m = 0.0;           ///< of the shell
  std::unique_ptr<ToolBody> tool_body;  ///< where there is a virtual tool, and it can be had
  mesh::TriangleMesh walls;             ///< with a virtual tool: of all objects at rest, in W
  std::unique_ptr<WallWatch> watch;     ///< where one of them is too thin to hold the tool for sure
  std::unique_ptr<ExactBodies> bodies;  ///< where a virtual tool meets triangles
  std::optional<effects::BodyShape> body;   ///< where an effect asks for it
  std::optional<ProximityField> proximity;  ///< likewise
  ToolPoints tool_points;                   ///< with `proximity`
  BuildCounts counts;                       ///< all but the contact's law, and the shell's bytes
};

/// Reads the meshes and builds. Throws as build_scene. In build_parts.cpp.
BuiltParts build_parts(const PartsRequest& request, const ParallelFor& parallel_for,
                       const Progress& progress);

}  // namespace voxtouch::rendering
