#pragma once
/// The meshes of a scene as a page draws them: large ones coarser.
#include <atomic>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.hpp"

namespace voxtouch::view {

/// {"meshes": [{"name", "role", "object", "positions", "indices", "triangles", "shown"}], "notes":
/// [sentence]}: static ones and moving objects in W where they rest, the dynamic one in T. A mesh
/// that cannot be read is a note. Reads files, until `stop`; takes as long as they are large.
nlohmann::json shapes_of(const scene::Scene& scene, const std::atomic<bool>& stop);

}  // namespace voxtouch::view
