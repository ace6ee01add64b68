#include "core/voxmap/smooth_block.hpp"

#include "core/types/clones.hpp"
#include "core/voxmap/interpolation.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr std::size_t kPlaces = SmoothBlock::kPlaces;

/// All positions at once. The work for one is unrolled, so that it stays in registers.
VOXTOUCH_CLONES void find_gradients(const double (&__restrict node)[64][kPlaces],
                                    const double (&__restrict t)[3][kPlaces], double band,
                                    double (&__restrict gradient)[3][kPlaces]) noexcept {
  constexpr std::size_t kStride[3] = {1, 4, 16};
  for (std::size_t n = 0; n < kPlaces; ++n) {
#pragma GCC unroll 3
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t along = kStride[axis], second = (axis + 1) % 3, third = (axis + 2) % 3;
      double line[4];
#pragma GCC unroll 4
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t first = kStride[second] * (1 + (k & 1)) + kStride[third] * (1 + (k >> 1));
        const double d0 = node[first][n], d1 = node[first + along][n],
                     d2 = node[first + 2 * along][n], d3 = node[first + 3 * along][n];
        const double before = d0 >= band ? 2.0 * d1 - d2 : d0,
                     after = d3 >= band ? 2.0 * d2 - d1 : d3;
        line[k] = 0.5 * mix(d2 - before, after - d1, t[axis][n]);
      }
      gradient[axis][n] = mix(mix(line[0], line[1], t[second][n]),
                              mix(line[2], line[3], t[second][n]), t[third][n]);
    }
  }
}

}  // namespace

void find_smooth(SmoothBlock& block, double band) noexcept {
  find_gradients(block.node, block.t, band, block.gradient);
}

}  // namespace voxtouch::voxmap
