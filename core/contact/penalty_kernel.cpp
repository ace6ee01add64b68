#include "core/contact/penalty_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/types/clones.hpp"
#if VOXTOUCH_WIDE_KERNELS
#include <immintrin.h>
#endif

namespace voxtouch::contact {

// Two doubles at once: available on every processor of the architecture.
namespace any_processor {
namespace {

constexpr std::size_t kWidth = 2;
using Doubles = double __attribute__((vector_size(16)));
#define VOXTOUCH_LOOK_UP(c, p) c[p[0]], c[p[1]]
#define VOXTOUCH_LOOK_UP_SINGLE(c, p) c[p[0]], c[p[1]], c[p[2]], c[p[3]]
VOXTOUCH_INLINE Doubles quotient(Doubles a, Doubles b, Doubles) noexcept { return a / b; }
VOXTOUCH_INLINE Doubles root(Doubles a) noexcept {
  return Doubles{std::sqrt(a[0]), std::sqrt(a[1])};
}
using Fours = std::int32_t __attribute__((vector_size(16)));
VOXTOUCH_INLINE bool all_set(Fours mask) noexcept {
  return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
}
#include "core/contact/penalty_kernel.inc"
#undef VOXTOUCH_LOOK_UP
#undef VOXTOUCH_LOOK_UP_SINGLE

}  // namespace
}  // namespace any_processor

#if VOXTOUCH_WIDE_KERNELS
#define VOXTOUCH_LOOK_UP_SINGLE(c, p) \
  c[p[0]], c[p[1]], c[p[2]], c[p[3]], c[p[4]], c[p[5]], c[p[6]], c[p[7]]
// a / b from 1 / b rounded to nearest, which costs one division and is shared. The remainder of its
// product with b is exact with fused operations, so the second correction rounds like a division
// (Markstein 1990). No other result of this file uses fused operations.
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace avx2 {
namespace {

using Eights = std::int32_t __attribute__((vector_size(32)));
VOXTOUCH_INLINE bool all_set(Eights mask) noexcept {
  return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) == 255;
}
constexpr std::size_t kWidth = 4;
#define VOXTOUCH_LOOK_UP(c, p) c[p[0]], c[p[1]], c[p[2]], c[p[3]]
VOXTOUCH_INLINE __m256d quotient(__m256d a, __m256d b, __m256d inverse) noexcept {
  const __m256d near = a * inverse,
                nearer = _mm256_fmadd_pd(_mm256_fnmadd_pd(near, b, a), inverse, near);
  return _mm256_fmadd_pd(_mm256_fnmadd_pd(nearer, b, a), inverse, nearer);
}
VOXTOUCH_INLINE __m256d root(__m256d a) noexcept { return _mm256_sqrt_pd(a); }
#include "core/contact/penalty_kernel.inc"
#undef VOXTOUCH_LOOK_UP

}  // namespace
}  // namespace avx2
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,avx2,fma")
namespace avx512 {
namespace {

using Eights = std::int32_t __attribute__((vector_size(32)));
VOXTOUCH_INLINE bool all_set(Eights mask) noexcept {
  return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) == 255;
}
constexpr std::size_t kWidth = 8;
#define VOXTOUCH_LOOK_UP(c, p) \
  c[p[0]], c[p[1]], c[p[2]], c[p[3]], c[p[4]], c[p[5]], c[p[6]], c[p[7]]
VOXTOUCH_INLINE __m512d quotient(__m512d a, __m512d b, __m512d inverse) noexcept {
  const __m512d near = a * inverse,
                nearer = _mm512_fmadd_pd(_mm512_fnmadd_pd(near, b, a), inverse, near);
  return _mm512_fmadd_pd(_mm512_fnmadd_pd(nearer, b, a), inverse, nearer);
}
VOXTOUCH_INLINE __m512d root(__m512d a) noexcept { return _mm512_sqrt_pd(a); }
#include "core/contact/penalty_kernel.inc"
#undef VOXTOUCH_LOOK_UP

}  // namespace
}  // namespace avx512
#pragma GCC pop_options
#undef VOXTOUCH_LOOK_UP_SINGLE
#endif

const PenaltyKernel& penalty_kernel(Instructions instructions) noexcept {
#if VOXTOUCH_WIDE_KERNELS
  if (instructions == Instructions::kAvx512)
    return avx512::kKernel;
  if (instructions == Instructions::kAvx2)
    return avx2::kKernel;
#endif
  static_cast<void>(instructions);
  return any_processor::kKernel;
}

}  // namespace voxtouch::contact
