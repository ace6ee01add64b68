#pragma once
/// Outward side of each triangle of a mesh, independent of the orientation in the file.
#include <cstdint>
#include <vector>

#include "core/voxmap/closed_shells.hpp"

namespace voxtouch::voxmap {

/// For each triangle +1 if its normal, by the order of its corners, points out of the solid, and -1
/// if it points in. Loading only: allocates.
/// The interior is that of the voxels (winding.hpp). The wall of a cavity thus faces the cavity,
/// and an inverted body, alone or among others, still faces outward. The orientation of the file
/// (+1) is kept for three kinds of triangles: those of open parts, which have no outside; those of
/// parts that cannot be oriented; and those of walls buried in a body, with solid on both sides.
std::vector<std::int8_t> outward_sides(const GridMesh& mesh, const ClosedShells& shells);

}  // namespace voxtouch::voxmap
