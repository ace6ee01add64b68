#pragma once
/// Origin of the voxel grid of a static object, chosen so that axis-aligned faces lie inside voxels
/// and not on their borders.
///
/// Faces of designed parts lie at whole millimetres, hence exactly on the borders of a grid at
/// multiples of e. Rounding then decides whether a face has a layer of voxels on one side or on
/// both. Contact models would begin half a voxel early or late, and a wall of one voxel would have
/// no interior. A face at the centre of its voxel avoids this best, and it coincides with the
/// tangent plane of its voxel that `original` and `adapted` use.
#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

/// Offset of the grid borders on each axis, as a fraction of a voxel beyond the multiples of e:
/// multiples of 1/1024 in [0, 1).
///
/// On each axis it minimises, over the faces across it, the sum of area times squared distance from
/// the face to the centre of its voxel. Faces that cannot all be centred thus share the offset by
/// their areas. Among minima equal to 1e-9, the one whose faces fill their voxels least is chosen,
/// by the orientation of their triangles. A wall of half a voxel then contains a voxel corner.
/// Among these, the smallest offset is chosen. A face is a triangle within 1e-3 of the axis, in
/// slope and in voxels. Without such faces the offset is 0. One pass over the triangles, no
/// allocation; their order affects rounding only. Requires a mesh and an edge that `default_grid`
/// accepts.
Vec3 clearance_of_faces(const mesh::TriangleMesh& mesh, double edge) noexcept;

/// The default grid of a static object. It is `default_grid` without axis-aligned faces. Otherwise
/// it starts up to one voxel earlier, so that its borders have those offsets, with one or two
/// layers of free voxels in front of the mesh. Throws like `default_grid`.
Grid object_grid(const mesh::TriangleMesh& mesh, double edge);

}  // namespace voxtouch::voxmap
