#pragma once
/// Whether a point lies inside the closed shells of a mesh: exactly counted crossings of a ray.
#include <cstdint>
#include <span>

#include "core/voxmap/closed_shells.hpp"

namespace voxtouch::voxmap {

/// `at`: a point in grid coordinates that no listed triangle contains. `triangles`: at least all
/// that a ray from it along +z can meet.
/// A point is inside if the winding number of the oriented shells is not 0, or if the number of
/// crossings with some unoriented shell is odd. An inverted mesh or two overlapping shells thus
/// have the usual interior, and a cavity whose wall faces inward is outside. No rounding: ties are
/// broken alike for both triangles of an edge.
bool inside_shells(const GridMesh& mesh, const ClosedShells& shells,
                   std::span<const std::uint32_t> triangles, const Vec3& at);

}  // namespace voxtouch::voxmap
