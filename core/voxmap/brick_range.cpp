#include "core/voxmap/brick_range.hpp"

#include <algorithm>

#include "core/types/clones.hpp"
#include "core/voxmap/brick_distances.hpp"

namespace voxtouch::voxmap {
namespace {

constexpr int kVoxels = DistanceField::kBrickEdge;

/// Eight values at the corners of a box, and bounds of the interpolation between them.
using Corners = std::array<double, 8>;  // corner (x, y, z) at x + 2 y + 4 z

double interpolated(const Corners& d, double x, double y, double z) noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < 8; ++n)
    sum += d[n] * (n & 1 ? x : 1.0 - x) * (n & 2 ? y : 1.0 - y) * (n & 4 ? z : 1.0 - z);
  return sum;
}

/// Largest squared gradient in a box of side 1. Each component is linear along each axis, so its
/// square is convex along each, and the sum is largest at one of the eight corners.
VOXTOUCH_INLINE double steepest_square(double d0, double d1, double d2, double d3, double d4,
                                       double d5, double d6, double d7) noexcept {
  const double x0 = (d1 - d0) * (d1 - d0), x1 = (d3 - d2) * (d3 - d2), x2 = (d5 - d4) * (d5 - d4),
               x3 = (d7 - d6) * (d7 - d6);
  const double y0 = (d2 - d0) * (d2 - d0), y1 = (d3 - d1) * (d3 - d1), y2 = (d6 - d4) * (d6 - d4),
               y3 = (d7 - d5) * (d7 - d5);
  const double z0 = (d4 - d0) * (d4 - d0), z1 = (d5 - d1) * (d5 - d1), z2 = (d6 - d2) * (d6 - d2),
               z3 = (d7 - d3) * (d7 - d3);
  const auto larger = [](double a, double b) { return a < b ? b : a; };
  const double low = larger(larger(x0 + y0 + z0, x0 + y1 + z1), larger(x1 + y0 + z2, x1 + y1 + z3));
  const double high =
      larger(larger(x2 + y2 + z0, x2 + y3 + z1), larger(x3 + y2 + z2, x3 + y3 + z3));
  return larger(low, high);
}

/// The same where the interpolation is below 0, to an eighth of the voxel, or `best` if that is
/// larger.
double steepest_square_inside(const Corners& d, double side, int splits, double best) noexcept {
  const auto [least, most] = std::minmax_element(d.begin(), d.end());
  if (*least >= 0.0)
    return best;
  const double whole =
      steepest_square(d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]) / (side * side);
  if (whole <= best)
    return best;
  if (splits == 0 || *most < 0.0)
    return whole;
  std::array<double, 27> halves;  // (x, y, z) halves at x + 3 y + 9 z
  for (std::size_t n = 0; n < 27; ++n)
    halves[n] =
        interpolated(d, 0.5 * static_cast<double>(n % 3), 0.5 * static_cast<double>(n / 3 % 3),
                     0.5 * static_cast<double>(n / 9));
  for (std::size_t part = 0; part < 8; ++part) {
    Corners octant;
    for (std::size_t n = 0; n < 8; ++n)
      octant[n] = halves[(part & 1) + (n & 1) + 3 * ((part >> 1 & 1) + (n >> 1 & 1)) +
                         9 * ((part >> 2) + (n >> 2))];
    best = steepest_square_inside(octant, side / 2.0, splits - 1, best);
  }
  return best;
}

/// All voxels of a row along x at once.
struct Row {
  float least[kVoxels];      ///< corner of each
  double steepest[kVoxels];  ///< square
  /// Corners so far, of the voxels with that x.
  float least_of_all[kVoxels], most_of_all[kVoxels];
};

/// `d`: first node of the row; `y`, `z`: strides to its neighbours.
VOXTOUCH_CLONES void look_at_row(const float* d, std::size_t y, std::size_t z, Row& row) noexcept {
  const auto less = [](float a, float b) { return b < a ? b : a; };
  const auto more = [](float a, float b) { return a < b ? b : a; };
  for (std::size_t x = 0; x < kVoxels; ++x) {
    const float d0 = d[x], d1 = d[x + 1], d2 = d[x + y], d3 = d[x + y + 1], d4 = d[x + z],
                d5 = d[x + z + 1], d6 = d[x + y + z], d7 = d[x + y + z + 1];
    const float least = less(less(less(d0, d1), less(d2, d3)), less(less(d4, d5), less(d6, d7)));
    const float most = more(more(more(d0, d1), more(d2, d3)), more(more(d4, d5), more(d6, d7)));
    row.least[x] = least;
    row.least_of_all[x] = less(least, row.least_of_all[x]),
    row.most_of_all[x] = more(most, row.most_of_all[x]);
    row.steepest[x] = steepest_square(d0, d1, d2, d3, d4, d5, d6, d7);
  }
}

}  // namespace

BrickRange range_of(const DistanceField::Brick& brick) noexcept {
  double best = 1.0;
  Row row;
  std::fill_n(row.least_of_all, kVoxels, brick[0]), std::fill_n(row.most_of_all, kVoxels, brick[0]);
  for (int z = 0; z < kVoxels; ++z)
    for (int y = 0; y < kVoxels; ++y) {
      const float* const d = &brick[node_of_brick(0, y, z)];
      look_at_row(d, node_of_brick(0, 1, 0), node_of_brick(0, 0, 1), row);
      for (std::size_t x = 0; x < kVoxels; ++x) {
        if (row.least[x] >= 0.0F || row.steepest[x] <= best)
          continue;
        Corners voxel;
        for (int n = 0; n < 8; ++n)
          voxel[static_cast<std::size_t>(n)] = d[x + node_of_brick(n & 1, n >> 1 & 1, n >> 2)];
        best = steepest_square_inside(voxel, 1.0, 3, best);
      }
    }
  return {*std::min_element(row.least_of_all, row.least_of_all + kVoxels),
          *std::max_element(row.most_of_all, row.most_of_all + kVoxels), best};
}

}  // namespace voxtouch::voxmap
