#pragma once
/// Bins of directions on the sphere, fixed in W: the vertices and edge centres of an icosahedron,
/// 31 to 36 degrees apart.
#include <cstddef>
#include <cstdint>

#include "core/types/geometry.hpp"

namespace voxtouch::contact {

inline constexpr std::size_t kDirectionBins = 42;

/// Normals (unit, in W) as structure of arrays, of the number processed together.
struct NormalBlock {
  static constexpr std::size_t kNormals = 64;
  std::size_t count = 0;
  alignas(64) double along[3][kNormals];
};

/// The bins nearest to the normals; for equal distances the first. Real-time safe.
void nearest_direction_bins(const NormalBlock& normals,
                            std::uint32_t (&bins)[NormalBlock::kNormals]) noexcept;

}  // namespace voxtouch::contact
