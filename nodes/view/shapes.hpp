#pragma once
/// The meshes of a scene as a page draws them: large ones coarser.
#include <cstddef>

#include <nlohmann/json_fwd.hpp>

#include "core/scene/scene.hpp"

namespace voxtouch::view {

/// Triangles that a page draws at 30 pictures a second also where it has no graphics card, over all meshes of a scene.
inline constexpr std::size_t kMostTriangles = 60'000;

/// {"meshes": [{"name", "role", "object", "positions", "indices", "triangles", "shown"}], "notes": [sentence]}: static ones and moving
/// objects in W where they rest, the dynamic one in T. A mesh that cannot be read is a note. Reads files; takes as long as they are large.
nlohmann::json shapes_of(const scene::Scene& scene);

}  // namespace voxtouch::view
