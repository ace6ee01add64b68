#pragma once
/// Builds a voxmap from a mesh: surface and interior voxels of the static scene (paper, section 1).
///
/// *surface*: a triangle meets the closed voxel; separating-axis test, exact in grid coordinates u
/// = (x - origin) / e for any doubles u. u itself is rounded once. Vertices, origin and e that are
/// multiples of a power of two (and short enough) make it exact. Others move a vertex by at most
/// 2^-52 |u| voxels, equally for all triangles that share it, so no hole can open.
///
/// *interior*: not surface, and inside the closed parts of the mesh (`closed_shells.hpp`). Voxels
/// that are not surface are grouped by common faces. All voxels of a group have the same winding
/// number, which is computed exactly for one voxel centre. Nested shells, overlapping shells,
/// cavities and inverted meshes thus follow the winding number, and an open part has a surface but
/// no interior.
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::voxmap {

/// Throws std::runtime_error for an unusable mesh and VoxelBudgetError for one that exceeds the
/// limit, both without any allocation. Concatenate several static meshes; surface takes precedence
/// over interior. Bit-identical for any `parallel_for`.
Voxmap voxelise(const mesh::TriangleMesh& mesh, const Grid& grid, const ParallelFor& parallel_for,
                std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);

}  // namespace voxtouch::voxmap
