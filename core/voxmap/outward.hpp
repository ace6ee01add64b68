#pragma once
/// Outward side of each triangle of a mesh, independent of the orientation in the file.
#include <cstdint>
#include <vector>

#include "core/voxmap/closed_shells.hpp"

namespace voxtouch::voxmap {

/// For each triangle +1 if its normal, by the order of its corners, points out of the solid, and -1
/// if it points in. Loading only: allocates.
/// The interior is that of the voxels (winding.hpp). The wall of a cavity thus faces the cavity,
/// and an inverted body, alone or among others, still faces outward. Three kinds of triangles keep
/// the orientation of the file (+1). They belong to open parts, which have no outside, to parts
/// that cannot be oriented, or to walls inside a body, with solid on both sides.
std::vector<std::int8_t> outward_sides(const GridMesh& mesh, const ClosedShells& shells);

}  // namespace voxtouch::voxmap
