#pragma once
/// Whether features pass through each other while their points move on straight lines from one pose
/// to the next.
///
/// The points of both meshes move linearly over t in [0, 1]. A mesh that is free of intersections
/// before the step has some after it only if, at some t, a vertex lies on a face or two edges meet;
/// so these two tests together are complete (Provot 1997). Both find the times at which the four
/// points are coplanar, the roots of a cubic, by bisection to the end, and then look at the
/// distance at that time. All real-time safe.
#include <array>

#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// A point that moves from `from` to `to`.
struct MovingPoint {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  Vec3 at(double t) const noexcept { return from + t * (to - from); }
};

/// Whether `vertex` passes through, or touches, the triangle.
bool vertex_passes_face(const MovingPoint& vertex, const std::array<MovingPoint, 3>& face) noexcept;

/// Whether the edges pass through, or touch, each other.
bool edges_pass(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b) noexcept;

/// Whether the segment meets the triangle, with limits::kTouchM to spare at its sides.
bool segment_meets_triangle(const Vec3& from, const Vec3& to,
                            const std::array<Vec3, 3>& triangle) noexcept;

}  // namespace voxtouch::exact
