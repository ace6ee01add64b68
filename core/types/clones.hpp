#pragma once
/// VOXTOUCH_CLONES before a function: one source, compiled for what the processor has. All versions
/// do the same IEEE operations in the same order (contraction into fused multiply-adds is off), so
/// the bits do not depend on the choice. What such a function calls must be inlined into it, or it
/// stays at the baseline: VOXTOUCH_INLINE.
///
/// Sanitizers do not stand the start-up resolver that this needs: with them the baseline alone is
/// compiled.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VOXTOUCH_NO_CLONES)
#define VOXTOUCH_CLONES \
  __attribute__((target_clones("default", "sse4.1", "avx2", "arch=x86-64-v4")))
#else
#define VOXTOUCH_CLONES
#endif
#define VOXTOUCH_INLINE inline __attribute__((always_inline))
