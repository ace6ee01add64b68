#pragma once
/// A mesh as a voxmap: surface and interior voxels of the static side (paper, section 1).
///
/// *surface*: a triangle meets the closed voxel; separating-axis test, exact in grid coordinates u
/// = (x - origin) / e for any doubles u. u itself is rounded once: vertices, origin and e that are
/// multiples of a power of two (and short enough) make it exact; any others move a vertex by at
/// most 2^-52 |u| voxels, alike for all triangles that share it, so no hole can open. *interior*:
/// not surface and inside the mesh's closed parts (`closed_shells.hpp`). Voxels that are not
/// surface are grouped by common faces; a group's winding number is one number, found exactly for
/// one voxel centre. So nested shells, overlapping shells, cavities and inverted meshes come out as
/// the winding number says, and an open part has a surface but no interior.
#include "core/types/parallel.hpp"
#include "core/voxmap/grid_mesh.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::voxmap {

/// Throws std::runtime_error for a mesh that cannot be used and VoxelBudgetError for one that would
/// not fit; both before memory is spent. Several static meshes: concatenate them; surface wins over
/// interior. Bit-identical whatever `parallel_for` does.
Voxmap voxelise(const mesh::TriangleMesh& mesh, const Grid& grid, const ParallelFor& parallel_for,
                std::uint64_t memory_limit_bytes = kVoxelMemoryLimit);

}  // namespace voxtouch::voxmap
