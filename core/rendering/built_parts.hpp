#pragma once
/// What is made of a scene's meshes: all that takes time, apart from all that the rest of the scene
/// says. It can be kept and read again.
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/effects/rigid_body.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/rendering/build.hpp"
#include "core/rendering/object_contacts.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/proximity_field.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// What of a scene and its choices decides how its parts are built.
struct PartsRequest {
  const scene::Scene& scene;
  const BuildChoices& choices;
  contact::ContactModelKind model;  ///< the one chosen, else the scene's
};

struct BuiltParts {
  std::vector<std::unique_ptr<StaticObject>>
      objects;  ///< without their renderers and edges' queries; those with meshes, in the order of
                ///< their ids
  pointshell::Pointshell shell;
  double largest_gap_m = 0.0;               ///< of the shell
  std::unique_ptr<ToolBody> tool_body;      ///< where there is a virtual tool, and it can be had
  std::optional<effects::BodyShape> body;   ///< where an effect asks for it
  std::optional<ProximityField> proximity;  ///< likewise
  ToolPoints tool_points;                   ///< with `proximity`
  BuildCounts counts;                       ///< all but the contact's law, and the shell's bytes
};

/// Reads the meshes and builds. Throws as build_scene. In build_parts.cpp.
BuiltParts build_parts(const PartsRequest& request, const ParallelFor& parallel_for,
                       const Progress& progress);

/// All that the parts depend on, as bytes: equal where they come out equal, bit for bit. Of the
/// meshes it holds `store`'s digests; reads their files. Empty where that cannot be said, since the
/// scene does not tell which bytes it was read with. Throws MeshError. In parts_recipe.cpp.
std::string recipe_of(const PartsRequest& request, const SceneStore& store);

/// The parts as bytes, and again from bytes, for the same request. `parts_from` throws
/// StoredBytesError for bytes that are no such parts; what it gives, every lookup stands. In
/// stored_parts.cpp.
std::string stored(const BuiltParts& parts);
BuiltParts parts_from(std::string_view bytes, const PartsRequest& request);
/// Bytes that `stored` will give, roughly, before anything is allocated.
std::uint64_t expected_bytes(const BuiltParts& parts) noexcept;

}  // namespace voxtouch::rendering
