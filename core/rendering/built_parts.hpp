#pragma once
/// Parts built from the meshes of a scene: everything that takes time, separate from the other
/// settings of the scene.
#include <memory>
#include <optional>
#include <vector>

#include "core/effects/rigid_body.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/proximity_field.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// The settings of a scene and its options that determine how its parts are built.
struct PartsRequest {
  const scene::Scene& scene;
  const BuildChoices& choices;
  contact::ContactModelKind model;  ///< the selected model, or the scene's

  /// A scene rendered with another model has no virtual tool.
  bool virtual_tool() const noexcept {
    return scene.virtual_tool() && model == contact::ContactModelKind::kField;
  }
};

struct BuiltParts {
  std::vector<std::unique_ptr<StaticObject>>
      objects;  ///< without their renderers; objects with meshes, in the order of their ids
  pointshell::Pointshell shell;
  double largest_gap_m = 0.0;               ///< of the shell
  std::unique_ptr<ExactBodies> bodies;      ///< of a virtual tool
  std::optional<effects::BodyShape> body;   ///< exists if an effect needs it
  std::optional<ProximityField> proximity;  ///< exists if an effect needs it
  ToolPoints tool_points;                   ///< with `proximity`
  BuildCounts counts;  ///< everything except the contact law and the memory of the shell
};

/// Reads the meshes and builds the parts. Throws as build_scene. Defined in build_parts.cpp.
BuiltParts build_parts(const PartsRequest& request, const ParallelFor& parallel_for,
                       const Progress& progress);

}  // namespace voxtouch::rendering
