#pragma once
/// Where the voxel grid of what can be touched begins: so that faces along its axes lie inside of
/// voxels, not on their borders.
///
/// Faces of designed parts lie at whole millimetres, hence exactly on the borders of a grid whose
/// borders are multiples of e. A face on a border has a layer of voxels on both sides or on one, as
/// rounding decides: contact models then begin half a voxel early or late, and a wall of one voxel
/// has no inside. A face in the middle of its voxel is farthest from that, and the tangent plane of
/// its voxel, which `original` and `adapted` know of it, is the face itself.
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

/// Where the borders of the grid lie for each axis, as a fraction of a voxel past the multiples of
/// e: whole 1/1024 in [0, 1).
///
/// Chosen an axis at a time: least is the sum over the faces across it of area times squared
/// distance from the face to the middle of the voxel it is in. So faces that cannot all lie in a
/// middle divide the offset by their areas, and none is given up for another. Of several minima,
/// equal to 1e-9, the one whose faces fill their voxels least (a wall of half a voxel then has a
/// voxel's corner in it), as their triangles are oriented; then the smallest offset. A face is a
/// triangle within 1e-3 of the axis, in slope and in voxels. Where no face lies across an axis, 0.
/// One pass over the triangles, no allocation; their order matters to rounding only. For a mesh and
/// an edge that `default_grid` takes.
Vec3 clearance_of_faces(const mesh::TriangleMesh& mesh, double edge) noexcept;

/// The default grid of a static object: `default_grid` where no face lies along the grid, else
/// begun earlier, by less than a voxel, for its borders to lie at those offsets: one or two layers
/// of free voxels before the mesh. Throws like `default_grid`.
Grid object_grid(const mesh::TriangleMesh& mesh, double edge);

}  // namespace voxtouch::voxmap
