#pragma once
/// A few dozen hits as structure of arrays, for kernels that sum over them: worked out once, used while they are in the first cache.
#include <algorithm>
#include <cstddef>

#include "core/contact/hit_list.hpp"
#include "core/types/clones.hpp"

namespace voxtouch::contact {

struct HitBlock {
  static constexpr std::size_t kHits = 32;
  alignas(64) double arm[3][kHits], normal[3][kHits], to_centre[3][kHits], weight[kHits];
};

/// floor(u) for |u| < 2^51: to the nearest whole number, by adding one so large that there is no room for a fraction, and one less
/// where that is above.
VOXTOUCH_INLINE double whole_below(double u) noexcept {
  constexpr double kNoFraction = 0x1.8p52;
  const double nearest = (u + kNoFraction) - kNoFraction;
  return nearest - (nearest > u ? 1.0 : 0.0);
}

namespace hit_block_detail {

VOXTOUCH_INLINE void look_up(const double* const columns[3], const std::uint32_t* points,
                             double (&out)[3][HitBlock::kHits]) noexcept {
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t n = 0; n < HitBlock::kHits; ++n) out[row][n] = columns[row][points[n]];
}

}  // namespace hit_block_detail

/// The hits' normals and weights alone: `count` of them, the rest of the block is the last once more.
VOXTOUCH_INLINE void fill_normals(const HitSource& s, const std::uint32_t* points, HitBlock& block) noexcept {
  double p[3][HitBlock::kHits];
  hit_block_detail::look_up(s.normal, points, p);
  for (std::size_t row = 0; row < 3; ++row) {
    const double r0 = s.r[row][0], r1 = s.r[row][1], r2 = s.r[row][2];
    for (std::size_t n = 0; n < HitBlock::kHits; ++n) block.normal[row][n] = row_sum(row, r0 * p[0][n], r1 * p[1][n], r2 * p[2][n]);
  }
  for (std::size_t n = 0; n < HitBlock::kHits; ++n) block.weight[n] = s.area != nullptr ? s.area[points[n]] : 1.0;
}

/// Arms and ways to the centres; the same bits as HitSource::hit.
VOXTOUCH_INLINE void fill_places(const HitSource& s, const std::uint32_t* points, HitBlock& block) noexcept {
  double p[3][HitBlock::kHits];
  hit_block_detail::look_up(s.place, points, p);
  for (std::size_t row = 0; row < 3; ++row) {
    const double r0 = s.r[row][0], r1 = s.r[row][1], r2 = s.r[row][2], t = s.t[row], edge = s.edge;
    for (std::size_t n = 0; n < HitBlock::kHits; ++n) {
      const double x = r0 * p[0][n], y = r1 * p[1][n], z = r2 * p[2][n];
      const double u = (x + y + z + t) / edge;
      block.arm[row][n] = row_sum(row, x, y, z);
      block.to_centre[row][n] = edge * ((whole_below(u) + 0.5) - u);
    }
  }
}

/// The numbers of the hits from `begin` on, filled up to a block with the first of them. \returns how many are real.
VOXTOUCH_INLINE std::size_t block_points(const Hits& hits, std::size_t begin, std::size_t end,
                                         std::uint32_t (&points)[HitBlock::kHits]) noexcept {
  const std::size_t count = std::min(HitBlock::kHits, end - begin);
  const std::uint32_t* const from = hits.points() + begin;
  for (std::size_t n = 0; n < count; ++n) points[n] = from[n];
  for (std::size_t n = count; n < HitBlock::kHits; ++n) points[n] = from[0];
  return count;
}

/// Of a list that was written by hand.
inline std::size_t copy_given(const Hit* given, std::size_t begin, std::size_t end, HitBlock& block) noexcept {
  const std::size_t count = std::min(HitBlock::kHits, end - begin);
  for (std::size_t n = 0; n < HitBlock::kHits; ++n) {
    const Hit& hit = given[begin + (n < count ? n : 0)];
    for (int row = 0; row < 3; ++row)
      block.arm[row][n] = hit.arm[row], block.normal[row][n] = hit.normal[row], block.to_centre[row][n] = hit.to_centre[row];
    block.weight[n] = hit.weight;
  }
  return count;
}

/// Of the hits [begin, end), at most a block. \returns how many are real.
VOXTOUCH_INLINE std::size_t fill_only_normals(const Hits& hits, std::size_t begin, std::size_t end, HitBlock& block) noexcept {
  if (hits.given() != nullptr) return copy_given(hits.given(), begin, end, block);
  std::uint32_t points[HitBlock::kHits];
  const std::size_t count = block_points(hits, begin, end, points);
  fill_normals(hits.source(), points, block);
  return count;
}

/// All of them.
VOXTOUCH_INLINE std::size_t fill(const Hits& hits, std::size_t begin, std::size_t end, HitBlock& block) noexcept {
  if (hits.given() != nullptr) return copy_given(hits.given(), begin, end, block);
  std::uint32_t points[HitBlock::kHits];
  const std::size_t count = block_points(hits, begin, end, points);
  fill_normals(hits.source(), points, block);
  fill_places(hits.source(), points, block);
  return count;
}

}  // namespace voxtouch::contact
