// Plain loops for any processor; the other kernels must give the same results.
#include "core/contact/leaf_kernel.hpp"

#include <cmath>

#include "core/types/clones.hpp"
#if VOXTOUCH_WIDE_KERNELS
#include <immintrin.h>
#endif

namespace voxtouch::contact {
namespace {

constexpr std::size_t kNodes = SphereTree::kFanOut, kRun = SphereTree::kLeafPoints;

inline float within(float u, float low, float high) noexcept {
  const float above = u > low ? u : low;
  return above < high ? above : high;
}

std::uint32_t near_spheres(const Lookup& lookup, const SphereTree::Level& level,
                           std::size_t first) noexcept {
  const QueryFrame& f = lookup.frame;
  const float* const x = level.x.data() + first;
  const float* const y = level.y.data() + first;
  const float* const z = level.z.data() + first;
  const int shift_of_cell = lookup.map.free_shift;
  const float half = 0.5F * static_cast<float>(1 << shift_of_cell),
              step = voxmap::free_distance::step_of(shift_of_cell);
  float offset[kNodes] = {}, outside[kNodes] = {};
  std::int32_t cell[3][kNodes];
  for (std::size_t row = 0; row < 3; ++row) {
    const float a0 = f.a[row][0], a1 = f.a[row][1], a2 = f.a[row][2], shift = f.corner_shift[row],
                size = f.size[row];
    for (std::size_t n = 0; n < kNodes; ++n) {
      const float u = a0 * x[n] + a1 * y[n] + a2 * z[n] + shift, w = within(u, 0.0F, size);
      const std::int32_t c = static_cast<std::int32_t>(w) >> shift_of_cell;
      const float off = u - (static_cast<float>(c << shift_of_cell) + half);
      outside[n] += (u - w) * (u - w);
      offset[n] += off * off;
      cell[row][n] = c;
    }
  }
  const auto ny = static_cast<std::uint32_t>(lookup.map.free_cells[1]),
             nz = static_cast<std::uint32_t>(lookup.map.free_cells[2]);
  std::uint32_t near = 0;
  for (std::size_t n = 0; n < kNodes; ++n) {
    const std::uint32_t at =
        (static_cast<std::uint32_t>(cell[0][n]) * ny + static_cast<std::uint32_t>(cell[1][n])) *
            nz +
        static_cast<std::uint32_t>(cell[2][n]);
    const float free = step * voxmap::free_distance::steps(lookup.map.free[at]);
    const float needed = level.radius[first + n] * f.per_metre + f.margin;
    const float spare = free - needed;
    const float reach = spare > 0.0F ? spare : 0.0F;
    const bool clear = (reach * reach > offset[n]) | (outside[n] > needed * needed);
    near |= static_cast<std::uint32_t>(!clear) << n;
  }
  return near;
}

inline std::int32_t brick_of(const voxmap::Voxmap::Arrays& map, std::int32_t x, std::int32_t y,
                             std::int32_t z) noexcept {
  if (map.table != nullptr)
    return map.table[x + map.cells_along[0] * (y + map.cells_along[1] * z)];
  const voxmap::Voxmap::Block block =
      map.blocks[(x >> 2) + map.blocks_along[0] * ((y >> 2) + map.blocks_along[1] * (z >> 2))];
  const std::int32_t code =
      map.pages[block.page][static_cast<std::size_t>((x & 3) | (y & 3) << 2 | (z & 3) << 4)];
  return code < voxmap::Voxmap::kSharedCode ? block.first_brick + code
                                            : code - voxmap::Voxmap::kSharedCode;
}

std::array<std::uint8_t, 3> classify(const Lookup& lookup, Leaves& leaves) noexcept {
  const QueryFrame& f = lookup.frame;
  const auto* const words = reinterpret_cast<const HalfWord*>(lookup.map.bricks);
  std::array<std::uint8_t, 3> any{};
  for (std::size_t n = 0; n < leaves.count; ++n) {
    const float* const x = lookup.data.x + kRun * leaves.leaf[n];
    const float* const y = lookup.data.y + kRun * leaves.leaf[n];
    const float* const z = lookup.data.z + kRun * leaves.leaf[n];
    std::int32_t v[3][kRun];
    float farthest[kRun] = {};  // of the three coordinates from the voxel centre
    for (std::size_t row = 0; row < 3; ++row) {
      const float a0 = f.a[row][0], a1 = f.a[row][1], a2 = f.a[row][2], shift = f.shift[row],
                  low = f.low[row], high = f.high[row];
      for (std::size_t p = 0; p < kRun; ++p) {
        const float u = within(a0 * x[p] + a1 * y[p] + a2 * z[p] + shift, low, high);
        const auto i = static_cast<std::int32_t>(u);
        const float off = std::abs((u - static_cast<float>(i)) - 0.5F);
        farthest[p] = off > farthest[p] ? off : farthest[p];
        v[row][p] = i + f.first[row];
      }
    }
    unsigned surface = 0, interior = 0, unsure = 0;
    for (std::size_t p = 0; p < kRun; ++p) {
      const std::int32_t brick = brick_of(lookup.map, v[0][p] >> 3, v[1][p] >> 3, v[2][p] >> 3);
      const std::int32_t voxel = (v[0][p] & 7) | (v[1][p] & 7) << 3 | (v[2][p] & 7) << 6;
      const std::uint32_t kind = words[brick * kHalfWords + (voxel >> 4)] >> (2 * (voxel & 15));
      surface |= (kind & 1U) << p, interior |= (kind >> 1 & 1U) << p;
      unsure |= static_cast<unsigned>(!(farthest[p] < f.certain)) << p;
    }
    leaves.surface[n] = static_cast<std::uint8_t>(surface), any[0] |= leaves.surface[n];
    leaves.interior[n] = static_cast<std::uint8_t>(interior), any[1] |= leaves.interior[n];
    leaves.unsure[n] = static_cast<std::uint8_t>(unsure), any[2] |= leaves.unsure[n];
  }
  return any;
}

void append(const Leaves& leaves, const Chosen& chosen, FoundHits& found) noexcept {
  std::uint32_t* out = found.points + found.count;
  for (std::size_t c = 0; c < chosen.count; ++c) {
    const std::size_t n = chosen.leaf[c];
    const auto first = static_cast<std::uint32_t>(kRun * leaves.leaf[n]);
    for (std::size_t k = 0; k < kRun; ++k)
      out[k] = first + kBitsOf.places[chosen.bits[n]][k];
    out += kBitsOf.count[chosen.bits[n]];
  }
  found.count = static_cast<std::size_t>(out - found.points);
}

void add_normals(const HitSource& source, const Leaves& leaves, const Chosen& chosen,
                 NormalLanes& lanes) noexcept {
  for (std::size_t c = 0; c < chosen.count; ++c)
    for (std::size_t lane = 0; lane < kRun; ++lane) {
      const std::size_t n = chosen.leaf[c];
      if ((chosen.bits[n] >> lane & 1) == 0)
        continue;
      const std::size_t p = kRun * leaves.leaf[n] + lane;
      const double weight = source.area != nullptr ? source.area[p] : 1.0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        lanes.sum[axis][lane] += weight * source.normal[axis][p];
      lanes.sum[3][lane] += weight;
    }
}

constexpr LeafKernel kPlain = {near_spheres, classify, append, add_normals};

}  // namespace

#if VOXTOUCH_WIDE_KERNELS
static_assert(kRun == 8 && sizeof(voxmap::Voxmap::Block) == sizeof(long long));
#pragma GCC push_options
#pragma GCC target("avx2,fma,popcnt")
namespace avx2 {
namespace {

constexpr std::size_t kWidth = 8;
using Floats = float __attribute__((vector_size(4 * kWidth)));
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));
using Doubles = double __attribute__((vector_size(4 * kWidth)));

VOXTOUCH_INLINE Ints look_up(const int* from, Ints at) noexcept {
  return (Ints)_mm256_i32gather_epi32(from, (__m256i)at, 4);
}
VOXTOUCH_INLINE void blocks_of(const voxmap::Voxmap::Block* blocks, Ints at, Ints& page,
                               Ints& first) noexcept {
  const auto* const from = reinterpret_cast<const long long*>(blocks);
  const Ints low = (Ints)_mm256_i32gather_epi64(from, _mm256_castsi256_si128((__m256i)at), 8),
             high = (Ints)_mm256_i32gather_epi64(from, _mm256_extracti128_si256((__m256i)at, 1), 8);
  page = __builtin_shuffle(low, high, Ints{0, 2, 4, 6, 8, 10, 12, 14}),
  first = __builtin_shuffle(low, high, Ints{1, 3, 5, 7, 9, 11, 13, 15});
}
VOXTOUCH_INLINE bool any(Ints lanes) noexcept {
  return _mm256_testz_si256((__m256i)lanes, (__m256i)lanes) == 0;
}
/// The sign of each lane.
VOXTOUCH_INLINE unsigned bits_of(Ints lanes) noexcept {
  return static_cast<unsigned>(_mm256_movemask_ps((__m256)lanes));
}
VOXTOUCH_INLINE Floats of_leaves(const float* from, std::size_t a, std::size_t) noexcept {
  return _mm256_loadu_ps(from + a);
}
VOXTOUCH_INLINE __m256i mask_of(unsigned bits, std::size_t half) noexcept {
  const __m256i each =
      half == 0 ? _mm256_setr_epi64x(1, 2, 4, 8) : _mm256_setr_epi64x(16, 32, 64, 128);
  return _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(bits), each), each);
}
/// Zero where the mask is not set; no memory is read there.
VOXTOUCH_INLINE Doubles chosen_of(const double* from, __m256i mask) noexcept {
  return _mm256_maskload_pd(from, mask);
}
#include "core/contact/leaf_kernel.inc"

}  // namespace
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,avx2,fma,popcnt")
namespace avx512 {
namespace {

constexpr std::size_t kWidth = 16;
using Floats = float __attribute__((vector_size(4 * kWidth)));
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));
using Doubles = double __attribute__((vector_size(4 * kWidth)));

VOXTOUCH_INLINE Ints look_up(const int* from, Ints at) noexcept {
  return (Ints)_mm512_i32gather_epi32((__m512i)at, from, 4);
}
VOXTOUCH_INLINE void blocks_of(const voxmap::Voxmap::Block* from, Ints at, Ints& page,
                               Ints& first) noexcept {
  const Ints even = {0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30};
  const Ints low = (Ints)_mm512_i32gather_epi64(_mm512_castsi512_si256((__m512i)at), from, 8),
             high =
                 (Ints)_mm512_i32gather_epi64(_mm512_extracti64x4_epi64((__m512i)at, 1), from, 8);
  page = __builtin_shuffle(low, high, even), first = __builtin_shuffle(low, high, even + 1);
}
VOXTOUCH_INLINE bool any(Ints lanes) noexcept {
  return _mm512_test_epi32_mask((__m512i)lanes, (__m512i)lanes) != 0;
}
VOXTOUCH_INLINE unsigned bits_of(Ints lanes) noexcept {
  return _mm512_movepi32_mask((__m512i)lanes);
}
VOXTOUCH_INLINE Floats of_leaves(const float* from, std::size_t a, std::size_t b) noexcept {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(from + a)),
                            _mm256_loadu_ps(from + b), 1);
}
VOXTOUCH_INLINE __mmask8 mask_of(unsigned bits, std::size_t) noexcept {
  return static_cast<__mmask8>(bits);
}
VOXTOUCH_INLINE Doubles chosen_of(const double* from, __mmask8 mask) noexcept {
  return _mm512_maskz_loadu_pd(mask, from);
}
#include "core/contact/leaf_kernel.inc"

}  // namespace
}  // namespace avx512
#pragma GCC pop_options
#endif

const LeafKernel& leaf_kernel(Instructions instructions) noexcept {
#if VOXTOUCH_WIDE_KERNELS
  if (instructions == Instructions::kAvx512)
    return avx512::kKernel;
  if (instructions == Instructions::kAvx2)
    return avx2::kKernel;
#endif
  static_cast<void>(instructions);
  return kPlain;
}

}  // namespace voxtouch::contact
