#pragma once
/// Smooth gradients of the distance field at eight positions at once. These loops have compiler
/// options of their own (CMakeLists.txt).
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::voxmap {

/// Inputs and results of DistanceField::smooth_gradients.
struct SmoothBlock {
  static constexpr std::size_t kPlaces = DistanceField::kSmoothTogether;
  /// 4 x 4 x 4 nodes, x first, then y, then z, around each position's voxel [e]; nodes beyond its
  /// corners on two axes are unused.
  alignas(64) double node[64][kPlaces];
  alignas(64) double t[3][kPlaces];  ///< positions in their voxels, 0 to 1
  alignas(64) double gradient[3][kPlaces];
};

/// Computes the gradients. `band`: distances from there on are cut off [e]. Bit-identical on every
/// processor. Real-time safe.
void find_smooth(SmoothBlock& block, double band) noexcept;

}  // namespace voxtouch::voxmap
