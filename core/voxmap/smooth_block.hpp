#pragma once
/// Smooth gradients of the distance field for eight places at once: the loops, whose options are
/// their own (CMakeLists.txt).
#include "core/voxmap/distance_field.hpp"

namespace voxtouch::voxmap {

/// What DistanceField::smooth_gradients looks up of its places, and what it makes of it.
struct SmoothBlock {
  static constexpr std::size_t kPlaces = DistanceField::kSmoothTogether;
  /// Of 4 x 4 x 4, x first, then y, then z, round each place's voxel [e]; those beyond its corners
  /// on two axes are not looked at.
  alignas(64) double node[64][kPlaces];
  alignas(64) double t[3][kPlaces];  ///< places in their voxels, 0 to 1
  alignas(64) double gradient[3][kPlaces];
};

/// Fills in the gradients. `band`: distances from there on are cut off [e]. Bit-identical on every
/// processor. Real-time safe.
void find_smooth(SmoothBlock& block, double band) noexcept;

}  // namespace voxtouch::voxmap
