#pragma once
/// What is asked of a whole brick of a distance field once it is filled.
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::voxmap {

/// Of a brick: its least and largest node, and the largest square of its interpolation's gradient
/// where that is below 0, to an eighth of a voxel; at least 1, the true distance's. Outside a
/// convex edge distances fan out, which is steep and pushes nothing.
struct BrickRange {
  float least, most;
  double steepest_square;
};
BrickRange range_of(const DistanceField::Brick& brick) noexcept;

}  // namespace voxtouch::voxmap
