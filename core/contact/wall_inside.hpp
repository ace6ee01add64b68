#pragma once
/// Whether a wall stands inside the tool. The rows do not determine it: they are of the tool's
/// points, and a wall thinner than a voxel has no inside that they could be deep in.
#include "core/contact/hit_list.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Whether a point of the static object lies deeper inside the tool than a start may be
/// (limits::kPlacedDepthEdges). From `hits`, kMostAsked of them at most, the object is followed
/// into the tool, along its surface: a point is of it that the field has inside, or in the middle
/// of a thin wall, from which the distances grow to either side. Such a point is inside the tool
/// where it is that deep behind every hit near it, by the hits' own normals. Not seen: walls inside
/// tools thinner than 1.25 voxels, and those between the hits that are asked. `local`: the tool's
/// origin from the grid's [m]. Real-time safe.
bool wall_inside_tool(const Hits& hits, const voxmap::DistanceField& field,
                      const Vec3& local) noexcept;

}  // namespace voxtouch::contact
