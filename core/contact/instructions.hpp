#pragma once
/// Selects the instruction set of the kernels for the contact query and its sums. All perform the
/// same IEEE operations in the same order, so results do not depend on it; a test compares them.
#include <cstdint>

/// The wider kernels use extensions of GCC.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VOXTOUCH_WIDE_KERNELS 1
#else
#define VOXTOUCH_WIDE_KERNELS 0
#endif

namespace voxtouch::contact {

enum class Instructions : std::uint8_t {
  kAny = 0,     ///< baseline of the compiled architecture
  kAvx2 = 1,    ///< AVX2 and FMA; FMA is used only for exact quotients
  kAvx512 = 2,  ///< AVX-512 F, DQ, BW, VL
};

/// The widest set of this processor.
Instructions widest_instructions() noexcept;

/// The selected set: the widest, unless `use_instructions` limits it. Real-time safe.
Instructions instructions() noexcept;

/// For tests and benchmarks: limits the set to `most`. Affects all threads; call it between two
/// frames.
void use_instructions(Instructions most) noexcept;

}  // namespace voxtouch::contact
