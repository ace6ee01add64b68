#pragma once
/// VOXTOUCH_CLONES before a function compiles it for several processors; the best version is
/// selected at run time. All versions do the same IEEE operations in the same order (no contraction
/// into fused multiply-adds), so results are bit-identical. Functions that it calls must be inlined
/// (VOXTOUCH_INLINE); otherwise they use the baseline.
///
/// Sanitizers do not support the start-up resolver: with them only the baseline is compiled.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VOXTOUCH_NO_CLONES)
#define VOXTOUCH_CLONES \
  __attribute__((target_clones("default", "sse4.1", "avx2", "arch=x86-64-v4")))
#else
#define VOXTOUCH_CLONES
#endif
#define VOXTOUCH_INLINE inline __attribute__((always_inline))
