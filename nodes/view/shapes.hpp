#pragma once
/// The meshes of a scene for the page; large ones are simplified.
#include <atomic>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.hpp"

namespace voxtouch::view {

/// {"meshes": [{"name", "role", "object", "positions", "indices", "triangles", "shown"}], "notes":
/// [sentence]}: static meshes and moving objects at rest in W, the dynamic mesh in T. An unreadable
/// mesh becomes a note. Reads files, which can take seconds; ends early on `stop`.
nlohmann::json shapes_of(const scene::Scene& scene, const std::atomic<bool>& stop);

}  // namespace voxtouch::view
