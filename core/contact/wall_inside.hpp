#pragma once
/// Detects a wall inside the tool. Constraint rows cannot detect it: they belong to points of the
/// tool, and a wall thinner than a voxel has no interior with depth.
#include "core/contact/hit_list.hpp"
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::contact {

/// Whether a point of the static object lies deeper inside the tool than a start allows
/// (limits::kPlacedDepthEdges). Real-time safe.
/// From at most kMostAsked of the `hits`, the search follows the object into the tool, along its
/// surface. A point belongs to the object if the field has it inside or if it is in the middle of a
/// thin wall. From such a middle the distances grow to either side. It is inside the tool if it is
/// that deep behind every nearby hit, by the hits' normals. Not detected: walls in tools thinner
/// than 1.25 voxels, and walls between the selected hits. `local`: the tool's origin relative to
/// the grid's [m].
bool wall_inside_tool(const Hits& hits, const voxmap::DistanceField& field,
                      const Vec3& local) noexcept;

}  // namespace voxtouch::contact
