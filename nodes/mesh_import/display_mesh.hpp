#pragma once
/// Meshes as something draws them, large ones coarser. What is felt has all triangles.
#include <cstddef>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::mesh_import {

/// In the frame that the scene names for the mesh, scaled and posed.
struct DisplayMesh {
  std::vector<float> positions;   ///< x y z of each vertex [m]
  std::vector<unsigned> indices;  ///< three a triangle
  std::size_t in_file = 0;        ///< triangles that the file has
  std::size_t triangles() const noexcept { return indices.size() / 3; }
};

/// With at most `most_triangles`, or nearly so. Reads in a process of its own; throws mesh::MeshError. Takes as long as the file is
/// large; not for the loop.
DisplayMesh read_display_mesh(const scene::MeshSpec& spec, double voxel_size_m, std::size_t most_triangles);
/// For people, where it has fewer triangles than its file; empty otherwise.
std::string what_is_left_out(const scene::MeshSpec& spec, const DisplayMesh& mesh);

}  // namespace voxtouch::mesh_import
