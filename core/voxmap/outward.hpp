#pragma once
/// Which way out of a body each triangle of a mesh faces, whatever way round the file has it.
#include <cstdint>
#include <vector>

#include "core/voxmap/closed_shells.hpp"

namespace voxtouch::voxmap {

/// For each triangle +1 where its normal, by the order of its corners, leads out of the solid, -1
/// where it leads in. "Inside" is that of the voxels (winding.hpp), so that the wall of a cavity
/// faces the cavity, and a body turned inside out, alone or next to others, faces outward all the
/// same. As the file has it (+1): triangles of open parts, which have no outside; of parts that
/// cannot be oriented; of walls buried in a body, which have the solid on both sides. Loading only:
/// allocates.
std::vector<std::int8_t> outward_sides(const GridMesh& mesh, const ClosedShells& shells);

}  // namespace voxtouch::voxmap
