#pragma once
/// Value ranges of a whole brick of a distance field after it is filled.
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::voxmap {

/// Smallest and largest node of a brick, and the largest squared gradient of its interpolation
/// where that is negative. The gradient is evaluated to an eighth of a voxel and is at least 1, the
/// slope of the true distance. Outside a convex edge the interpolation is steep, but there is no
/// force.
struct BrickRange {
  float least, most;
  double steepest_square;
};
BrickRange range_of(const DistanceField::Brick& brick) noexcept;

}  // namespace voxtouch::voxmap
