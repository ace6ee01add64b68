#pragma once
/// One bit per voxel in bricks of 8x8x8, the form in which voxels are collected and filled, eight
/// words at a time.
#include <array>
#include <cstdint>

namespace voxtouch::voxmap {

/// Word z contains the slice z of a brick, voxel (x, y) at bit x + 8 y.
using BrickMask = std::array<std::uint64_t, 8>;

inline constexpr std::uint64_t kLowX = 0x0101010101010101ULL;   ///< x = 0
inline constexpr std::uint64_t kHighX = 0x8080808080808080ULL;  ///< x = 7

inline bool any(const BrickMask& m) noexcept {
  return (m[0] | m[1] | m[2] | m[3] | m[4] | m[5] | m[6] | m[7]) != 0;
}

/// All voxels of `room` connected by faces with `seed`, which is in `room`.
inline BrickMask grow(BrickMask seed, const BrickMask& room) noexcept {
  for (;;) {
    std::uint64_t changed = 0;
    const auto step = [&](std::size_t z) {
      std::uint64_t m = seed[z];
      m |= ((m & ~kHighX) << 1) | ((m & ~kLowX) >> 1) | (m << 8) | (m >> 8);
      if (z > 0)
        m |= seed[z - 1];
      if (z < 7)
        m |= seed[z + 1];
      m &= room[z];
      changed |= m ^ seed[z];
      seed[z] = m;
    };
    for (std::size_t z = 0; z < 8; ++z)
      step(z);  // forward and back: most shapes need two or three rounds
    for (std::size_t z = 8; z-- > 0;)
      step(z);
    if (changed == 0)
      return seed;
  }
}

/// The voxels on the low (side 0) or high (side 1) face across `axis`, as one word. Bits of
/// adjacent faces correspond.
inline std::uint64_t face(const BrickMask& m, int axis, int side) noexcept {
  if (axis == 2)
    return m[side ? 7 : 0];
  std::uint64_t bits = 0;
  for (std::size_t z = 0; z < 8; ++z) {
    if (axis == 1)
      bits |= ((m[z] >> (side ? 56 : 0)) & 0xffULL) << (8 * z);
    else
      bits |= ((((m[z] >> (side ? 7 : 0)) & kLowX) * 0x0102040810204080ULL) >> 56) << (8 * z);
  }
  return bits;
}

}  // namespace voxtouch::voxmap
