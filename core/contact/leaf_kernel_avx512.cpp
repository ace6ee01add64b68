// Sixteen points or spheres at once, as leaf_kernel.cpp has them one by one: the same operations in
// the same order.
#include "core/contact/leaf_kernel.hpp"

#if VOXTOUCH_WIDE_KERNELS
#include <immintrin.h>

#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,avx2,fma,popcnt")

namespace voxtouch::contact {
namespace avx512 {
namespace {

constexpr std::size_t kRun = SphereTree::kLeafPoints;
static_assert(kRun == 8 && SphereTree::kFanOut == 16);

/// One row of a p + shift, as the query's frame has it.
struct Row {
  __m512 a0, a1, a2, shift;
  Row(const float (&a)[3], float to) noexcept
      : a0(_mm512_set1_ps(a[0])),
        a1(_mm512_set1_ps(a[1])),
        a2(_mm512_set1_ps(a[2])),
        shift(_mm512_set1_ps(to)) {}
  __m512 at(__m512 x, __m512 y, __m512 z) const noexcept {
    const __m512 xy = _mm512_add_ps(_mm512_mul_ps(a0, x), _mm512_mul_ps(a1, y));
    return _mm512_add_ps(_mm512_add_ps(xy, _mm512_mul_ps(a2, z)), shift);
  }
};

/// What a coordinate is kept within: the second of both where it is no number.
struct Within {
  __m512 low, high;
  Within(float from, float to) noexcept : low(_mm512_set1_ps(from)), high(_mm512_set1_ps(to)) {}
  __m512 of(__m512 u) const noexcept { return _mm512_min_ps(_mm512_max_ps(u, low), high); }
};

inline __m512 square(__m512 a) noexcept { return _mm512_mul_ps(a, a); }

inline __m512 sum_of_squares(__m512 a, __m512 b, __m512 c) noexcept {
  return _mm512_add_ps(_mm512_add_ps(square(a), square(b)), square(c));
}

/// voxmap::free_distance::steps: the largest of its three lines.
inline __m512 steps_of(__m512i byte) noexcept {
  const __m512 b = _mm512_cvtepi32_ps(byte);
  const __m512 fine = _mm512_mul_ps(_mm512_set1_ps(0.25F), b);
  const __m512 middle =
      _mm512_sub_ps(_mm512_mul_ps(_mm512_set1_ps(0.5F), b), _mm512_set1_ps(24.0F));
  const __m512 coarse =
      _mm512_sub_ps(_mm512_mul_ps(_mm512_set1_ps(8.0F), b), _mm512_set1_ps(1344.0F));
  return _mm512_max_ps(_mm512_max_ps(fine, middle), coarse);
}

std::uint32_t near_spheres(const Lookup& lookup, const SphereTree::Level& level,
                           std::size_t first) noexcept {
  const QueryFrame& f = lookup.frame;
  const __m512 x = _mm512_loadu_ps(level.x.data() + first),
               y = _mm512_loadu_ps(level.y.data() + first),
               z = _mm512_loadu_ps(level.z.data() + first);
  const __m512 ux = Row(f.a[0], f.corner_shift[0]).at(x, y, z),
               uy = Row(f.a[1], f.corner_shift[1]).at(x, y, z),
               uz = Row(f.a[2], f.corner_shift[2]).at(x, y, z);
  const __m512 wx = Within(0.0F, f.size[0]).of(ux), wy = Within(0.0F, f.size[1]).of(uy),
               wz = Within(0.0F, f.size[2]).of(uz);
  const __m512 outside =
      sum_of_squares(_mm512_sub_ps(ux, wx), _mm512_sub_ps(uy, wy), _mm512_sub_ps(uz, wz));
  const int shift_of_cell = lookup.map.free_shift;
  const __m128i by = _mm_cvtsi32_si128(shift_of_cell);
  const __m512i cx = _mm512_sra_epi32(_mm512_cvttps_epi32(wx), by),
                cy = _mm512_sra_epi32(_mm512_cvttps_epi32(wy), by),
                cz = _mm512_sra_epi32(_mm512_cvttps_epi32(wz), by);
  const __m512 half = _mm512_set1_ps(0.5F * static_cast<float>(1 << shift_of_cell));
  const auto from_middle = [&](__m512 u, __m512i c) {
    return _mm512_sub_ps(u, _mm512_add_ps(_mm512_cvtepi32_ps(_mm512_sll_epi32(c, by)), half));
  };
  const __m512 way = sum_of_squares(from_middle(ux, cx), from_middle(uy, cy), from_middle(uz, cz));
  const __m512i ny = _mm512_set1_epi32(lookup.map.free_cells[1]),
                nz = _mm512_set1_epi32(lookup.map.free_cells[2]);
  const __m512i cell = _mm512_add_epi32(
      _mm512_mullo_epi32(_mm512_add_epi32(_mm512_mullo_epi32(cx, ny), cy), nz), cz);
  // Four bytes at a time: they are a multiple of four.
  const __m512i word = _mm512_i32gather_epi32(_mm512_srli_epi32(cell, 2), lookup.map.free, 4);
  const __m512i shift = _mm512_slli_epi32(_mm512_and_si512(cell, _mm512_set1_epi32(3)), 3);
  const __m512 free = _mm512_mul_ps(
      _mm512_set1_ps(voxmap::free_distance::step_of(shift_of_cell)),
      steps_of(_mm512_and_si512(_mm512_srlv_epi32(word, shift), _mm512_set1_epi32(255))));
  const __m512 needed = _mm512_add_ps(
      _mm512_mul_ps(_mm512_loadu_ps(level.radius.data() + first), _mm512_set1_ps(f.per_metre)),
      _mm512_set1_ps(f.margin));
  const __m512 reach = _mm512_max_ps(_mm512_sub_ps(free, needed), _mm512_setzero_ps());
  const auto clear =
      static_cast<std::uint32_t>(_mm512_cmp_ps_mask(square(reach), way, _CMP_GT_OQ) |
                                 _mm512_cmp_ps_mask(outside, square(needed), _CMP_GT_OQ));
  return ~clear & 0xffffU;
}

/// Which coordinates are so far from the faces of their voxels that they lie in them for certain;
/// `i` is set to the voxels.
inline unsigned certain(__m512 u, __m512 most, __m512i& i) noexcept {
  i = _mm512_cvttps_epi32(u);
  const __m512 off = _mm512_sub_ps(_mm512_sub_ps(u, _mm512_cvtepi32_ps(i)), _mm512_set1_ps(0.5F));
  return _mm512_cmp_ps_mask(_mm512_abs_ps(off), most, _CMP_LT_OQ);
}

/// Places in rows of rows, as the table of cells and that of blocks have them.
struct Strides {
  __m512i x, y;
  explicit Strides(const std::array<std::int32_t, 2>& along) noexcept
      : x(_mm512_set1_epi32(along[0])),
        y(_mm512_set1_epi32(along[1])) {}
  __m512i place(__m512i at_x, __m512i at_y, __m512i at_z) const noexcept {
    return _mm512_add_epi32(
        at_x, _mm512_mullo_epi32(x, _mm512_add_epi32(at_y, _mm512_mullo_epi32(y, at_z))));
  }
};

/// Pairs of leaves that are worked on together, as leaf_kernel_avx2.cpp has leaves.
constexpr std::size_t kTogether = 4;
struct Voxels {
  __m512i x[kTogether], y[kTogether], z[kTogether];
};

/// The bricks of voxels, one look each.
struct TableOfBricks {
  const std::int32_t* table;
  Strides cells;
  explicit TableOfBricks(const voxmap::Voxmap::Arrays& map) noexcept
      : table(map.table),
        cells(map.cells_along) {}
  void find(const Voxels& v, std::size_t count, __m512i* bricks) const noexcept {
    for (std::size_t n = 0; n < count; ++n)
      bricks[n] = _mm512_i32gather_epi32(
          cells.place(_mm512_srai_epi32(v.x[n], 3), _mm512_srai_epi32(v.y[n], 3),
                      _mm512_srai_epi32(v.z[n], 3)),
          table, 4);
  }
};

/// The same of a map without a table.
struct PagesOfBricks {
  const voxmap::Voxmap::Block* block_of;
  const voxmap::Voxmap::Page* pages;
  Strides blocks;
  explicit PagesOfBricks(const voxmap::Voxmap::Arrays& map) noexcept
      : block_of(map.blocks),
        pages(map.pages),
        blocks(map.blocks_along) {}
  void find(const Voxels& v, std::size_t count, __m512i* bricks) const noexcept {
    const __m512i even =
                      _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30),
                  odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
    __m512i page[kTogether];
    for (std::size_t n = 0; n < count; ++n) {
      const __m512i at = blocks.place(_mm512_srai_epi32(v.x[n], 5), _mm512_srai_epi32(v.y[n], 5),
                                      _mm512_srai_epi32(v.z[n], 5));
      const __m512i low = _mm512_i32gather_epi64(_mm512_castsi512_si256(at), block_of, 8),
                    high = _mm512_i32gather_epi64(_mm512_extracti64x4_epi64(at, 1), block_of, 8);
      page[n] = _mm512_permutex2var_epi32(low, even, high);
      bricks[n] = _mm512_permutex2var_epi32(low, odd, high);  // the first one of the block
    }
    for (std::size_t n = 0; n < count; ++n) {
      const __m512i bits = _mm512_set1_epi32(24);  // of the cell in its block
      const __m512i row = _mm512_or_si512(_mm512_srli_epi32(_mm512_and_si512(v.y[n], bits), 3),
                                          _mm512_srli_epi32(_mm512_and_si512(v.z[n], bits), 1));
      const __m512i word =
          _mm512_i32gather_epi32(_mm512_add_epi32(_mm512_slli_epi32(page[n], 4), row), pages, 4);
      const __m512i code = _mm512_and_si512(_mm512_srlv_epi32(word, _mm512_and_si512(v.x[n], bits)),
                                            _mm512_set1_epi32(255));
      const __m512i most = _mm512_set1_epi32(voxmap::Voxmap::kSharedCode - 1);
      bricks[n] = _mm512_mask_add_epi32(_mm512_and_si512(code, most),
                                        _mm512_cmple_epi32_mask(code, most), code, bricks[n]);
    }
  }
};

/// Two leaves in one.
inline __m512 both(const float* values, std::size_t a, std::size_t b) noexcept {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(values + a)),
                            _mm256_loadu_ps(values + b), 1);
}

template <class Bricks>
std::array<std::uint8_t, 3> classify_by(const Lookup& lookup, Leaves& leaves) noexcept {
  const QueryFrame& f = lookup.frame;
  const QueryData& data = lookup.data;
  const Bricks bricks(lookup.map);
  const __m512i seven = _mm512_set1_epi32(7);
  const __m512i first_x = _mm512_set1_epi32(f.first[0]), first_y = _mm512_set1_epi32(f.first[1]),
                first_z = _mm512_set1_epi32(f.first[2]);
  const Row row_x(f.a[0], f.shift[0]), row_y(f.a[1], f.shift[1]), row_z(f.a[2], f.shift[2]);
  const Within in_x(f.low[0], f.high[0]), in_y(f.low[1], f.high[1]), in_z(f.low[2], f.high[2]);
  const __m512 most = _mm512_set1_ps(f.certain);
  unsigned any_surface = 0, any_interior = 0, any_unsure = 0;
  Voxels v;
  __m512i brick[kTogether];
  for (std::size_t begin = 0; begin < leaves.count; begin += 2 * kTogether) {
    const std::size_t left = (leaves.count - begin + 1) / 2,
                      count = left < kTogether ? left : kTogether;
    // Where there is no second leaf, its place in the lists is there all the same: they are of an
    // even length.
    const auto real = [&](std::size_t n) {
      return begin + 2 * n + 1 < leaves.count ? 0xffffU : 0xffU;
    };
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t at = begin + 2 * n, a = kRun * leaves.leaf[at],
                        b = real(n) == 0xffffU ? kRun * leaves.leaf[at + 1] : a;
      const __m512 x = both(data.x, a, b), y = both(data.y, a, b), z = both(data.z, a, b);
      __m512i ix, iy, iz;
      unsigned sure = certain(in_x.of(row_x.at(x, y, z)), most, ix);
      sure &= certain(in_y.of(row_y.at(x, y, z)), most, iy);
      sure &= certain(in_z.of(row_z.at(x, y, z)), most, iz);
      v.x[n] = _mm512_add_epi32(ix, first_x), v.y[n] = _mm512_add_epi32(iy, first_y),
      v.z[n] = _mm512_add_epi32(iz, first_z);
      const unsigned unsure = ~sure & real(n);
      leaves.unsure[at] = static_cast<std::uint8_t>(unsure),
      leaves.unsure[at + 1] = static_cast<std::uint8_t>(unsure >> 8);
      any_unsure |= unsure;
    }
    bricks.find(v, count, brick);
    for (std::size_t n = 0; n < count; ++n) {
      unsigned surface = 0, interior = 0;
      if (_mm512_test_epi32_mask(brick[n], brick[n]) != 0) {
        const __m512i voxel =
            _mm512_or_si512(_mm512_and_si512(v.x[n], seven),
                            _mm512_or_si512(_mm512_slli_epi32(_mm512_and_si512(v.y[n], seven), 3),
                                            _mm512_slli_epi32(_mm512_and_si512(v.z[n], seven), 6)));
        const __m512i place =
            _mm512_add_epi32(_mm512_slli_epi32(brick[n], 5), _mm512_srli_epi32(voxel, 4));
        static_assert(kHalfWords == 32);
        const __m512i shift = _mm512_slli_epi32(_mm512_and_si512(voxel, _mm512_set1_epi32(15)), 1);
        const __m512i kind =
            _mm512_srlv_epi32(_mm512_i32gather_epi32(place, lookup.map.bricks, 4), shift);
        surface = _mm512_test_epi32_mask(kind, _mm512_set1_epi32(1)) & real(n);
        interior = _mm512_test_epi32_mask(kind, _mm512_set1_epi32(2)) & real(n);
      }
      const std::size_t at = begin + 2 * n;
      leaves.surface[at] = static_cast<std::uint8_t>(surface),
      leaves.surface[at + 1] = static_cast<std::uint8_t>(surface >> 8);
      leaves.interior[at] = static_cast<std::uint8_t>(interior),
      leaves.interior[at + 1] = static_cast<std::uint8_t>(interior >> 8);
      any_surface |= surface, any_interior |= interior;
    }
  }
  const auto folded = [](unsigned bits) { return static_cast<std::uint8_t>(bits | bits >> 8); };
  return {folded(any_surface), folded(any_interior), folded(any_unsure)};
}

std::array<std::uint8_t, 3> classify(const Lookup& lookup, Leaves& leaves) noexcept {
  return lookup.map.table != nullptr ? classify_by<TableOfBricks>(lookup, leaves)
                                     : classify_by<PagesOfBricks>(lookup, leaves);
}

void append(const Leaves& leaves, const Chosen& chosen, FoundHits& found) noexcept {
  const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  std::uint32_t* out = found.points + found.count;
  for (std::size_t c = 0; c < chosen.count; ++c) {
    const std::size_t n = chosen.leaf[c];
    const unsigned bits = chosen.bits[n];
    const __m256i first = _mm256_set1_epi32(static_cast<std::int32_t>(kRun * leaves.leaf[n]));
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(out),
        _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), _mm256_add_epi32(first, lanes)));
    out += kBitsOf.count[bits];
  }
  found.count = static_cast<std::size_t>(out - found.points);
}

void add_normals(const HitSource& source, const Leaves& leaves, const Chosen& chosen,
                 NormalLanes& lanes) noexcept {
  __m512d sums[4];
  for (std::size_t k = 0; k < 4; ++k)
    sums[k] = _mm512_load_pd(lanes.sum[k]);
  for (std::size_t c = 0; c < chosen.count; ++c) {
    const std::size_t n = chosen.leaf[c];
    const std::size_t from = kRun * leaves.leaf[n];
    const __mmask8 mask = chosen.bits[n];
    const __m512d weight = source.area != nullptr ? _mm512_maskz_loadu_pd(mask, source.area + from)
                                                  : _mm512_maskz_mov_pd(mask, _mm512_set1_pd(1.0));
    for (std::size_t axis = 0; axis < 3; ++axis)
      sums[axis] = _mm512_add_pd(
          sums[axis],
          _mm512_mul_pd(weight, _mm512_maskz_loadu_pd(mask, source.normal[axis] + from)));
    sums[3] = _mm512_add_pd(sums[3], weight);
  }
  for (std::size_t k = 0; k < 4; ++k)
    _mm512_store_pd(lanes.sum[k], sums[k]);
}

}  // namespace
}  // namespace avx512

const LeafKernel kLeafKernelAvx512 = {avx512::near_spheres, avx512::classify, avx512::append,
                                      avx512::add_normals};

}  // namespace voxtouch::contact
#pragma GCC pop_options
#endif
