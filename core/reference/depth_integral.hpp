#pragma once
/// Integral of the penalty law over the tool's surface, refined only where the depth is nonlinear.
#include <functional>

#include "core/reference/reference_wrench.hpp"
#include "core/reference/tool_triangles.hpp"

namespace voxtouch::reference {

/// Signed distance of a point in W to the static triangles [m], negative inside. It is 1-Lipschitz,
/// which allows parts to be skipped.
using DepthQuery = std::function<double(const Vec3&)>;

/// ReferenceWrench's integral for the tool at `pose_WT`.
/// A part of the tool is skipped if its centre is farther outside than its extent, or if the free
/// balls around its corners cover it. Depths shared by neighbours are computed once. A triangle is
/// split into four while it is larger than four times the resolution. It is also split while the
/// depth at its edge midpoints or its centre deviates from linear by more than 2 % of
/// `resolution_m`. Triangles smaller than half the resolution are not split. Between these points
/// the depth is linear: exact for planes, also where they cut the tool.
TrueWrench integrate_depth(const ToolTriangles& tool, const Pose& pose_WT, double resolution_m,
                           const DepthQuery& distance);

}  // namespace voxtouch::reference
