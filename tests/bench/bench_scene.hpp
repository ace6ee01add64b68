#pragma once
/// The cup of 256 voxels that all figures of the query's speed are of, and tools of any number of
/// points in and about it.
#include <string>
#include <vector>

#include "core/pointshell/pointshell.hpp"
#include "core/voxmap/voxmap.hpp"

namespace voxtouch::bench {

inline constexpr double kEdge = 0.0005;  ///< voxel edge [m]

/// A cup 100 mm high with walls of 4 mm, its axis that of z.
voxmap::Voxmap cup();

/// Position of the tool: far away; inside the cup without contact; on its floor with 1 % of the
/// points; a plug that fills it, with a fifth of its points in the wall.
enum class Place { kFar, kNear, kLight, kHeavy };
std::string name_of(Place place);

/// The tool of that place: a ball of 25 mm, or the plug. Points at equal fractions of its surface,
/// in Morton order.
pointshell::Pointshell tool(Place place, std::size_t points);

/// Poses of a closed path about the place, less than half a voxel apart.
std::vector<Pose> path(Place place);
/// The first five poses forward and back, so that the cycle has no jump.
std::vector<Pose> eight_poses(Place place);

}  // namespace voxtouch::bench
