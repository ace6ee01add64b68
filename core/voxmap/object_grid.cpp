#include "core/voxmap/object_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace voxtouch::voxmap {
namespace {

constexpr int kSteps = 1024;  ///< offsets are multiples of 1 / kSteps of a voxel
constexpr double kFlat =
    1e-3;  ///< largest slope, and extent in voxels, of a triangle that is parallel to the grid
constexpr double kTie = 1e-9;  ///< of the area: sums this close differ by rounding only

/// The faces across one axis by their position in their voxel, from 0 to 1. Faces in one bin are
/// represented by their mean.
struct FacesAcross {
  std::array<double, kSteps> area{}, moment{};  ///< of all
  std::array<double, kSteps> facing{},
      facing_down{};  ///< the same, with faces pointing down the axis counted negative

  void add(double place, double size, bool up) noexcept {
    const auto bin =
        static_cast<std::size_t>(std::min(static_cast<int>(place * kSteps), kSteps - 1));
    const double sign = up ? 1.0 : -1.0;
    area[bin] += size, moment[bin] += size * place;
    facing[bin] += sign * size, facing_down[bin] += sign * size * place;
  }

  /// The offset with the smallest sum of squared distances to the voxel centres.
  double best_clearance() const noexcept {
    double all = 0.0, moments = 0.0, squares = 0.0, facings = 0.0, down_sum = 0.0;
    for (std::size_t n = 0; n < kSteps; ++n) {
      all += area[n], moments += moment[n], facings += facing[n], down_sum += facing_down[n];
      if (area[n] > 0.0)
        squares += moment[n] * (moment[n] / area[n]);
    }
    if (!(all > 0.0) || !std::isfinite(squares))
      return 0.0;
    // Positions lie on a circle of one voxel. Cut open at each bin in turn they are numbers. Their
    // mean is then the best centre, their scatter the sum, and `out` their outward displacement
    // from it.
    const auto for_each_cut = [&](auto&& f) {
      double before = 0.0, facing_before = 0.0,
             squares_ahead =
                 squares;  // values ahead of the cut, one voxel on; all squared positions
      for (std::size_t n = 0; n < kSteps; ++n) {
        const double mean = (moments + before) / all;
        f(mean, squares_ahead - mean * (moments + before),
          down_sum + facing_before - mean * facings);
        before += area[n], facing_before += facing[n], squares_ahead += 2.0 * moment[n] + area[n];
      }
    };
    double least = squares, least_out = std::numeric_limits<double>::infinity(), best = 1.0;
    for_each_cut([&](double, double scatter, double) { least = std::min(least, scatter); });
    const double tied = least + kTie * all;
    for_each_cut([&](double, double scatter, double out) {
      if (scatter <= tied)
        least_out = std::min(least_out, out);
    });
    for_each_cut([&](double mean, double scatter, double out) {
      if (scatter <= tied && out <= least_out + kTie * all)
        best = std::min(best, clearance_for(mean));
    });
    return best;
  }

  /// Borders half a voxel from `middle`.
  static double clearance_for(double middle) noexcept {
    const double steps = std::round((middle - 0.5) * kSteps);
    return (steps - kSteps * std::floor(steps / kSteps)) / kSteps;
  }
};

}  // namespace

Vec3 clearance_of_faces(const mesh::TriangleMesh& mesh, double edge) noexcept {
  std::array<FacesAcross, 3> across;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const Vec3 normal = (b - a).cross(c - a);  // twice the area
    Eigen::Index axis = 0;
    const double size = normal.cwiseAbs().maxCoeff(&axis);
    const double rest = normal.squaredNorm() - size * size;
    if (!(size > 0.0) || !(rest <= kFlat * kFlat * size * size))
      continue;
    const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
    if (!(high - low <= kFlat * edge))
      continue;
    const double place = (low + 0.5 * (high - low)) / edge;
    if (!std::isfinite(place))
      continue;
    across[static_cast<std::size_t>(axis)].add(place - std::floor(place), size, normal[axis] > 0.0);
  }
  return {across[0].best_clearance(), across[1].best_clearance(), across[2].best_clearance()};
}

Grid object_grid(const mesh::TriangleMesh& mesh, double edge) {
  Grid grid = default_grid(mesh, edge);
  const Vec3 clearance = clearance_of_faces(mesh, edge);
  for (int axis = 0; axis < 3; ++axis)
    if (clearance[axis] > 0.0)
      grid.origin[axis] = edge * (std::round(grid.origin[axis] / edge) - 1.0 + clearance[axis]);
  return grid;
}

}  // namespace voxtouch::voxmap
