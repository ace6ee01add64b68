#pragma once
/// The sphere of directions in bins, fixed in W: the vertices and the edge middles of an
/// icosahedron, 31 to 36 degrees apart.
#include <cstddef>
#include <cstdint>

#include "core/types/geometry.hpp"

namespace voxtouch::contact {

inline constexpr std::size_t kDirectionBins = 42;

/// Normals (unit, in W) as structure of arrays, as many as are looked at together.
struct NormalBlock {
  static constexpr std::size_t kNormals = 64;
  std::size_t count = 0;
  alignas(64) double along[3][kNormals];
};

/// The bins whose directions are nearest to the normals; of two as near the first. Real-time safe.
void nearest_direction_bins(const NormalBlock& normals,
                            std::uint32_t (&bins)[NormalBlock::kNormals]) noexcept;

}  // namespace voxtouch::contact
