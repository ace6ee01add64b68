#pragma once
/// For which processor the kernels of the contact query and of its sums are chosen. All do the same
/// IEEE operations in the same order, so the bits do not depend on it; a test holds them against
/// each other.
#include <cstdint>

/// Where the wider kernels are compiled: their code is GCC's.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VOXTOUCH_WIDE_KERNELS 1
#else
#define VOXTOUCH_WIDE_KERNELS 0
#endif

namespace voxtouch::contact {

enum class Instructions : std::uint8_t {
  kAny = 0,   ///< what every processor of the kind has that this was compiled for
  kAvx2 = 1,  ///< AVX2 and FMA, which is used for quotients that are exact with it, and for nothing
              ///< else
  kAvx512 = 2,  ///< AVX-512 F, DQ, BW, VL
};

/// The widest that this processor has.
Instructions widest_instructions() noexcept;

/// Those in use: the widest, unless `use_instructions` said less. Real-time safe.
Instructions instructions() noexcept;

/// For tests and benchmarks: `most` from now on, or the widest that there are. For all threads,
/// between two frames.
void use_instructions(Instructions most) noexcept;

}  // namespace voxtouch::contact
