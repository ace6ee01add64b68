// Eight points or spheres at once, as leaf_kernel.cpp has them one by one: the same operations in
// the same order.
#include "core/contact/leaf_kernel.hpp"

#if VOXTOUCH_WIDE_KERNELS
#include <immintrin.h>

#pragma GCC push_options
#pragma GCC target("avx2,fma,popcnt")

namespace voxtouch::contact {
namespace avx2 {
namespace {

constexpr std::size_t kRun = SphereTree::kLeafPoints;
static_assert(kRun == 8 && SphereTree::kFanOut == 16);

/// One row of a p + shift, as the query's frame has it.
struct Row {
  __m256 a0, a1, a2, shift;
  Row(const float (&a)[3], float to) noexcept
      : a0(_mm256_set1_ps(a[0])),
        a1(_mm256_set1_ps(a[1])),
        a2(_mm256_set1_ps(a[2])),
        shift(_mm256_set1_ps(to)) {}
  __m256 at(__m256 x, __m256 y, __m256 z) const noexcept {
    const __m256 xy = _mm256_add_ps(_mm256_mul_ps(a0, x), _mm256_mul_ps(a1, y));
    return _mm256_add_ps(_mm256_add_ps(xy, _mm256_mul_ps(a2, z)), shift);
  }
};

/// What a coordinate is kept within: the second of both where it is no number.
struct Within {
  __m256 low, high;
  Within(float from, float to) noexcept : low(_mm256_set1_ps(from)), high(_mm256_set1_ps(to)) {}
  __m256 of(__m256 u) const noexcept { return _mm256_min_ps(_mm256_max_ps(u, low), high); }
};

inline __m256 square(__m256 a) noexcept { return _mm256_mul_ps(a, a); }

inline __m256 sum_of_squares(__m256 a, __m256 b, __m256 c) noexcept {
  return _mm256_add_ps(_mm256_add_ps(square(a), square(b)), square(c));
}

/// voxmap::free_distance::steps: the largest of its three lines.
inline __m256 steps_of(__m256i byte) noexcept {
  const __m256 b = _mm256_cvtepi32_ps(byte);
  const __m256 fine = _mm256_mul_ps(_mm256_set1_ps(0.25F), b);
  const __m256 middle =
      _mm256_sub_ps(_mm256_mul_ps(_mm256_set1_ps(0.5F), b), _mm256_set1_ps(24.0F));
  const __m256 coarse =
      _mm256_sub_ps(_mm256_mul_ps(_mm256_set1_ps(8.0F), b), _mm256_set1_ps(1344.0F));
  return _mm256_max_ps(_mm256_max_ps(fine, middle), coarse);
}

inline std::uint32_t near_eight(const Lookup& lookup, const SphereTree::Level& level,
                                std::size_t first) noexcept {
  const QueryFrame& f = lookup.frame;
  const __m256 x = _mm256_loadu_ps(level.x.data() + first),
               y = _mm256_loadu_ps(level.y.data() + first),
               z = _mm256_loadu_ps(level.z.data() + first);
  const __m256 ux = Row(f.a[0], f.corner_shift[0]).at(x, y, z),
               uy = Row(f.a[1], f.corner_shift[1]).at(x, y, z),
               uz = Row(f.a[2], f.corner_shift[2]).at(x, y, z);
  const __m256 wx = Within(0.0F, f.size[0]).of(ux), wy = Within(0.0F, f.size[1]).of(uy),
               wz = Within(0.0F, f.size[2]).of(uz);
  const __m256 outside =
      sum_of_squares(_mm256_sub_ps(ux, wx), _mm256_sub_ps(uy, wy), _mm256_sub_ps(uz, wz));
  const int shift_of_cell = lookup.map.free_shift;
  const __m128i by = _mm_cvtsi32_si128(shift_of_cell);
  const __m256i cx = _mm256_sra_epi32(_mm256_cvttps_epi32(wx), by),
                cy = _mm256_sra_epi32(_mm256_cvttps_epi32(wy), by),
                cz = _mm256_sra_epi32(_mm256_cvttps_epi32(wz), by);
  const __m256 half = _mm256_set1_ps(0.5F * static_cast<float>(1 << shift_of_cell));
  const auto from_middle = [&](__m256 u, __m256i c) {
    return _mm256_sub_ps(u, _mm256_add_ps(_mm256_cvtepi32_ps(_mm256_sll_epi32(c, by)), half));
  };
  const __m256 way = sum_of_squares(from_middle(ux, cx), from_middle(uy, cy), from_middle(uz, cz));
  const __m256i ny = _mm256_set1_epi32(lookup.map.free_cells[1]),
                nz = _mm256_set1_epi32(lookup.map.free_cells[2]);
  const __m256i cell = _mm256_add_epi32(
      _mm256_mullo_epi32(_mm256_add_epi32(_mm256_mullo_epi32(cx, ny), cy), nz), cz);
  // Four bytes at a time: they are a multiple of four.
  const __m256i word = _mm256_i32gather_epi32(reinterpret_cast<const int*>(lookup.map.free),
                                              _mm256_srli_epi32(cell, 2), 4);
  const __m256i shift = _mm256_slli_epi32(_mm256_and_si256(cell, _mm256_set1_epi32(3)), 3);
  const __m256 free = _mm256_mul_ps(
      _mm256_set1_ps(voxmap::free_distance::step_of(shift_of_cell)),
      steps_of(_mm256_and_si256(_mm256_srlv_epi32(word, shift), _mm256_set1_epi32(255))));
  const __m256 needed = _mm256_add_ps(
      _mm256_mul_ps(_mm256_loadu_ps(level.radius.data() + first), _mm256_set1_ps(f.per_metre)),
      _mm256_set1_ps(f.margin));
  const __m256 reach = _mm256_max_ps(_mm256_sub_ps(free, needed), _mm256_setzero_ps());
  const __m256 clear = _mm256_or_ps(_mm256_cmp_ps(square(reach), way, _CMP_GT_OQ),
                                    _mm256_cmp_ps(outside, square(needed), _CMP_GT_OQ));
  return ~static_cast<std::uint32_t>(_mm256_movemask_ps(clear)) & 255U;
}

std::uint32_t near_spheres(const Lookup& lookup, const SphereTree::Level& level,
                           std::size_t first) noexcept {
  return near_eight(lookup, level, first) | near_eight(lookup, level, first + 8) << 8;
}

/// Whether a coordinate is so far from the faces of its voxel that it lies in it for certain; `i`
/// is set to the voxel.
inline __m256 certain(__m256 u, __m256 most, __m256i& i) noexcept {
  i = _mm256_cvttps_epi32(u);
  const __m256 off = _mm256_sub_ps(_mm256_sub_ps(u, _mm256_cvtepi32_ps(i)), _mm256_set1_ps(0.5F));
  return _mm256_cmp_ps(_mm256_andnot_ps(_mm256_set1_ps(-0.0F), off), most, _CMP_LT_OQ);
}

/// Places in rows of rows, as the table of cells and that of blocks have them.
struct Strides {
  __m256i x, y;
  explicit Strides(const std::array<std::int32_t, 2>& along) noexcept
      : x(_mm256_set1_epi32(along[0])),
        y(_mm256_set1_epi32(along[1])) {}
  __m256i place(__m256i at_x, __m256i at_y, __m256i at_z) const noexcept {
    return _mm256_add_epi32(
        at_x, _mm256_mullo_epi32(x, _mm256_add_epi32(at_y, _mm256_mullo_epi32(y, at_z))));
  }
};

/// Leaves that are worked on together, loop by loop: each look of one does not wait for those of
/// the one before it, and so many are on their way at once, however far away in memory.
constexpr std::size_t kTogether = 8;
struct Voxels {
  __m256i x[kTogether], y[kTogether], z[kTogether];
};

/// The bricks of voxels, one look each.
struct TableOfBricks {
  const int* table;
  Strides cells;
  explicit TableOfBricks(const voxmap::Voxmap::Arrays& map) noexcept
      : table(map.table),
        cells(map.cells_along) {}
  void find(const Voxels& v, std::size_t count, __m256i* bricks) const noexcept {
    for (std::size_t n = 0; n < count; ++n)
      bricks[n] = _mm256_i32gather_epi32(
          table,
          cells.place(_mm256_srai_epi32(v.x[n], 3), _mm256_srai_epi32(v.y[n], 3),
                      _mm256_srai_epi32(v.z[n], 3)),
          4);
  }
};

/// The same of a map without a table.
struct PagesOfBricks {
  const long long* block_of;
  const int* pages;
  Strides blocks;
  explicit PagesOfBricks(const voxmap::Voxmap::Arrays& map) noexcept
      : block_of(reinterpret_cast<const long long*>(map.blocks)),
        pages(reinterpret_cast<const int*>(map.pages)),
        blocks(map.blocks_along) {}
  void find(const Voxels& v, std::size_t count, __m256i* bricks) const noexcept {
    __m256i page[kTogether];
    for (std::size_t n = 0; n < count; ++n) {
      const __m256i at = blocks.place(_mm256_srai_epi32(v.x[n], 5), _mm256_srai_epi32(v.y[n], 5),
                                      _mm256_srai_epi32(v.z[n], 5));
      const __m256 low = _mm256_castsi256_ps(
                       _mm256_i32gather_epi64(block_of, _mm256_castsi256_si128(at), 8)),
                   high = _mm256_castsi256_ps(
                       _mm256_i32gather_epi64(block_of, _mm256_extracti128_si256(at, 1), 8));
      page[n] =
          _mm256_permute4x64_epi64(_mm256_castps_si256(_mm256_shuffle_ps(low, high, 0x88)), 0xd8);
      bricks[n] = _mm256_permute4x64_epi64(_mm256_castps_si256(_mm256_shuffle_ps(low, high, 0xdd)),
                                           0xd8);  // the first one of the block
    }
    for (std::size_t n = 0; n < count; ++n) {
      const __m256i bits = _mm256_set1_epi32(24);  // of the cell in its block
      const __m256i row = _mm256_or_si256(_mm256_srli_epi32(_mm256_and_si256(v.y[n], bits), 3),
                                          _mm256_srli_epi32(_mm256_and_si256(v.z[n], bits), 1));
      const __m256i word =
          _mm256_i32gather_epi32(pages, _mm256_add_epi32(_mm256_slli_epi32(page[n], 4), row), 4);
      const __m256i code = _mm256_and_si256(_mm256_srlv_epi32(word, _mm256_and_si256(v.x[n], bits)),
                                            _mm256_set1_epi32(255));
      const __m256i most = _mm256_set1_epi32(voxmap::Voxmap::kSharedCode - 1);
      bricks[n] = _mm256_add_epi32(_mm256_and_si256(code, most),
                                   _mm256_andnot_si256(_mm256_cmpgt_epi32(code, most), bricks[n]));
    }
  }
};

/// Bit `bit` of each lane.
inline unsigned bits(__m256i lanes, int bit) noexcept {
  return static_cast<unsigned>(
      _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_slli_epi32(lanes, 31 - bit))));
}

template <class Bricks>
std::array<std::uint8_t, 3> classify_by(const Lookup& lookup, Leaves& leaves) noexcept {
  const QueryFrame& f = lookup.frame;
  const Bricks bricks(lookup.map);
  const auto* const words = reinterpret_cast<const int*>(lookup.map.bricks);
  const __m256i seven = _mm256_set1_epi32(7);
  const __m256i first_x = _mm256_set1_epi32(f.first[0]), first_y = _mm256_set1_epi32(f.first[1]),
                first_z = _mm256_set1_epi32(f.first[2]);
  const Row row_x(f.a[0], f.shift[0]), row_y(f.a[1], f.shift[1]), row_z(f.a[2], f.shift[2]);
  const Within in_x(f.low[0], f.high[0]), in_y(f.low[1], f.high[1]), in_z(f.low[2], f.high[2]);
  const __m256 most = _mm256_set1_ps(f.certain);
  unsigned any_surface = 0, any_interior = 0, any_unsure = 0;
  Voxels v;
  __m256i brick[kTogether];
  for (std::size_t begin = 0; begin < leaves.count; begin += kTogether) {
    const std::size_t left = leaves.count - begin, count = left < kTogether ? left : kTogether;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t from = kRun * leaves.leaf[begin + n];
      const __m256 x = _mm256_loadu_ps(lookup.data.x + from),
                   y = _mm256_loadu_ps(lookup.data.y + from),
                   z = _mm256_loadu_ps(lookup.data.z + from);
      __m256i ix, iy, iz;
      const __m256 sure_x = certain(in_x.of(row_x.at(x, y, z)), most, ix);
      const __m256 sure_y = certain(in_y.of(row_y.at(x, y, z)), most, iy);
      const __m256 sure_z = certain(in_z.of(row_z.at(x, y, z)), most, iz);
      const unsigned unsure = ~static_cast<unsigned>(_mm256_movemask_ps(
                                  _mm256_and_ps(_mm256_and_ps(sure_x, sure_y), sure_z))) &
                              255U;
      leaves.unsure[begin + n] = static_cast<std::uint8_t>(unsure), any_unsure |= unsure;
      v.x[n] = _mm256_add_epi32(ix, first_x), v.y[n] = _mm256_add_epi32(iy, first_y),
      v.z[n] = _mm256_add_epi32(iz, first_z);
    }
    bricks.find(v, count, brick);
    for (std::size_t n = 0; n < count; ++n) {
      unsigned surface = 0, interior = 0;
      if (_mm256_testz_si256(brick[n], brick[n]) == 0) {
        const __m256i voxel =
            _mm256_or_si256(_mm256_and_si256(v.x[n], seven),
                            _mm256_or_si256(_mm256_slli_epi32(_mm256_and_si256(v.y[n], seven), 3),
                                            _mm256_slli_epi32(_mm256_and_si256(v.z[n], seven), 6)));
        const __m256i place =
            _mm256_add_epi32(_mm256_slli_epi32(brick[n], 5), _mm256_srli_epi32(voxel, 4));
        static_assert(kHalfWords == 32);
        const __m256i shift = _mm256_slli_epi32(_mm256_and_si256(voxel, _mm256_set1_epi32(15)), 1);
        const __m256i kind = _mm256_srlv_epi32(_mm256_i32gather_epi32(words, place, 4), shift);
        surface = bits(kind, 0), interior = bits(kind, 1);
      }
      leaves.surface[begin + n] = static_cast<std::uint8_t>(surface), any_surface |= surface;
      leaves.interior[begin + n] = static_cast<std::uint8_t>(interior), any_interior |= interior;
    }
  }
  return {static_cast<std::uint8_t>(any_surface), static_cast<std::uint8_t>(any_interior),
          static_cast<std::uint8_t>(any_unsure)};
}

std::array<std::uint8_t, 3> classify(const Lookup& lookup, Leaves& leaves) noexcept {
  return lookup.map.table != nullptr ? classify_by<TableOfBricks>(lookup, leaves)
                                     : classify_by<PagesOfBricks>(lookup, leaves);
}

void append(const Leaves& leaves, const Chosen& chosen, FoundHits& found) noexcept {
  std::uint32_t* out = found.points + found.count;
  for (std::size_t c = 0; c < chosen.count; ++c) {
    const std::size_t n = chosen.leaf[c];
    const unsigned bits = chosen.bits[n];
    const __m256i first = _mm256_set1_epi32(static_cast<std::int32_t>(kRun * leaves.leaf[n]));
    const __m256i places = _mm256_cvtepu8_epi32(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kBitsOf.places[bits])));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_add_epi32(first, places));
    out += kBitsOf.count[bits];
  }
  found.count = static_cast<std::size_t>(out - found.points);
}

/// Half a leaf: lanes whose bit is not set add zero.
inline void add_half(const double* const (&normal)[3], const double* area, std::size_t first,
                     __m256i chosen, __m256d (&sums)[4]) noexcept {
  const __m256d weight = area != nullptr
                             ? _mm256_maskload_pd(area + first, chosen)
                             : _mm256_and_pd(_mm256_castsi256_pd(chosen), _mm256_set1_pd(1.0));
  for (std::size_t axis = 0; axis < 3; ++axis)
    sums[axis] = _mm256_add_pd(
        sums[axis], _mm256_mul_pd(weight, _mm256_maskload_pd(normal[axis] + first, chosen)));
  sums[3] = _mm256_add_pd(sums[3], weight);
}

void add_normals(const HitSource& source, const Leaves& leaves, const Chosen& chosen,
                 NormalLanes& lanes) noexcept {
  const __m256i low = _mm256_setr_epi64x(1, 2, 4, 8), high = _mm256_setr_epi64x(16, 32, 64, 128);
  __m256d first[4], second[4];
  for (std::size_t k = 0; k < 4; ++k)
    first[k] = _mm256_load_pd(lanes.sum[k]), second[k] = _mm256_load_pd(lanes.sum[k] + 4);
  for (std::size_t c = 0; c < chosen.count; ++c) {
    const std::size_t n = chosen.leaf[c];
    const std::size_t from = kRun * leaves.leaf[n];
    const __m256i mask = _mm256_set1_epi64x(chosen.bits[n]);
    add_half(source.normal, source.area, from, _mm256_cmpeq_epi64(_mm256_and_si256(mask, low), low),
             first);
    add_half(source.normal, source.area, from + 4,
             _mm256_cmpeq_epi64(_mm256_and_si256(mask, high), high), second);
  }
  for (std::size_t k = 0; k < 4; ++k)
    _mm256_store_pd(lanes.sum[k], first[k]), _mm256_store_pd(lanes.sum[k] + 4, second[k]);
}

}  // namespace
}  // namespace avx2

const LeafKernel kLeafKernelAvx2 = {avx2::near_spheres, avx2::classify, avx2::append,
                                    avx2::add_normals};

}  // namespace voxtouch::contact
#pragma GCC pop_options
#endif
