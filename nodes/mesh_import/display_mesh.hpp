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
  std::string
      note;  ///< sentence if it is drawn coarser than it is rendered, or not drawn; otherwise empty
  std::size_t triangles() const noexcept { return indices.size() / 3; }
};

/// The static meshes in the scene's order, then the dynamic one. Small ones are complete; large
/// ones get about equal parts of the rest of kMaxDrawnTriangles. Each is read in a separate
/// process; the time depends on the file sizes. The rest are empty once `stop` is set.
std::vector<DisplayMesh> read_display_meshes(const scene::Scene& scene,
                                             const std::atomic<bool>& stop);
/// Triangles that each of the meshes with `counts` triangles may keep, `most` in total.
std::vector<std::size_t> counts_of(const std::vector<std::size_t>& counts, std::size_t most);

}  // namespace voxtouch::mesh_import
