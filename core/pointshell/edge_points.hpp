#pragma once
/// The sharp edges of a static object that stand out of it, and the rims of its open parts, as
/// points: where interpolated distances are rounded, and where points of a tool's shell lie to
/// either side.
#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/closed_mesh.hpp"
#include "core/voxmap/grid.hpp"

namespace voxtouch::pointshell {

/// An edge is sharp where its triangles' planes are farther apart than this [rad], 25 degrees:
/// facets of round things are not.
inline constexpr double kSharpRad = 0.4363323129985824;
/// Points of an edge are no farther apart than this [voxels], and of points in one cube of so many
/// voxels the first is kept.
inline constexpr double kEdgePointsApart = 0.5;
inline constexpr double kEdgePointsCell = 0.25;

/// Points of the sharp edges with both ends: of closed parts those at which two triangles meet and
/// the solid is convex, or has no thickness; of open parts those from which all triangles lead to
/// one side, be it one (a rim), two (a fold) or more. `mesh` in `grid`, whose voxels the lengths
/// above are in. Positions [m] along W's axes from `grid.origin`, exact to rounding; a normal
/// points into the object, the mean of the ways into the triangles. Areas are 0. In Morton order.
/// Loading only: allocates.
Pointshell edge_points(const voxmap::ClosedMesh& mesh, const voxmap::Grid& grid);

}  // namespace voxtouch::pointshell
