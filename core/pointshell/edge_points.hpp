#pragma once
/// The sharp convex edges of a static object as points: where interpolated distances are rounded, and where points of a tool's shell lie to either side.
#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::pointshell {

/// An edge is sharp where the outward normals of its two triangles are farther apart than this [rad], 25 degrees: facets of round things are not.
inline constexpr double kSharpRad = 0.4363323129985824;
/// Points of an edge are no farther apart than this [voxels], and of points in one cube of so many voxels the first is kept.
inline constexpr double kEdgePointsApart = 0.5;
inline constexpr double kEdgePointsCell = 0.25;

/// Points of the edges of the closed parts at which two triangles meet and the solid is convex and sharp, with both ends. `mesh` in `grid`, whose
/// voxels the lengths above are in. Positions [m] along W's axes from `grid.origin`, exact to rounding; a normal points into the object, the opposite of
/// the mean of the triangles' at the point. Areas are 0. In Morton order. Edges of triangles without area, and where more than two meet, give none.
/// Loading only: allocates.
Pointshell edge_points(const voxmap::ClosedMesh& mesh, const voxmap::Grid& grid);

}  // namespace voxtouch::pointshell
