#pragma once
/// The penalty law's integral over the tool's surface, split only where the depth bends.
#include <functional>

#include "core/reference/reference_wrench.hpp"
#include "core/reference/tool_triangles.hpp"

namespace voxtouch::reference {

/// Signed distance of a point in W to the static triangles [m], negative inside. 1-Lipschitz, which
/// is what parts are left out by.
using DepthQuery = std::function<double(const Vec3&)>;

/// ReferenceWrench's integral for the tool at `pose_WT`. A part of the tool whose middle is farther
/// outside than it is wide is left out, or which the balls round its corners that reach nothing
/// cover; what neighbours share is asked for once. A triangle is split into four until the depth at
/// the middles of its edges and at its own lies within 2 % of `resolution_m` of what its corners
/// say (and it is no larger than four times the resolution: what is narrower could lie between), or
/// it is smaller than half of it. What is left is summed with depths that are linear between these
/// points: exact for planes, also where they are crossed.
TrueWrench integrate_depth(const ToolTriangles& tool, const Pose& pose_WT, double resolution_m,
                           const DepthQuery& distance);

}  // namespace voxtouch::reference
