#pragma once
/// Meshes as something draws them, large ones coarser. The rendering uses all triangles.
#include <atomic>
#include <cstddef>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::mesh_import {

/// Triangles of all meshes of a scene together: a browser without a graphics card draws them 30
/// times a second, and as corners in a message they are 1.4 MB.
inline constexpr std::size_t kMaxDrawnTriangles = 20'000;

/// In the frame that the scene names for the mesh, scaled and posed.
struct DisplayMesh {
  std::vector<float> positions;   ///< x y z of each vertex [m]
  std::vector<unsigned> indices;  ///< three a triangle
  std::size_t in_file = 0;        ///< triangles that the file has
  std::string note;  ///< for people: it is drawn coarser than it is rendered, or why it is not
                     ///< drawn at all; empty otherwise
  std::size_t triangles() const noexcept { return indices.size() / 3; }
};

/// The static meshes in the scene's order, then the dynamic one; small ones whole, large ones with
/// an equal part of what these leave of kMaxDrawnTriangles, or nearly so. Reads each in a process
/// of its own; takes as long as the files are large. The rest are empty once `stop` is set.
std::vector<DisplayMesh> read_display_meshes(const scene::Scene& scene,
                                             const std::atomic<bool>& stop);
/// What each of meshes with `counts` triangles may keep, so that they have `most` together.
std::vector<std::size_t> counts_of(const std::vector<std::size_t>& counts, std::size_t most);

}  // namespace voxtouch::mesh_import
