#include "core/contact/direction_bins.hpp"

#include <array>
#include <numbers>

namespace voxtouch::contact {
namespace {

std::array<Vec3, kDirectionBins> bin_directions() {
  const double g = std::numbers::phi;
  std::array<Vec3, kDirectionBins> out;
  std::size_t n = 0;
  for (const double a : {1.0, -1.0})
    for (const double b : {g, -g}) {
      out[n++] = Vec3(0, a, b);
      out[n++] = Vec3(a, b, 0);
      out[n++] = Vec3(b, 0, a);
    }
  // Vertices of this icosahedron are 2 apart where they share an edge, and farther otherwise.
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      if ((out[i] - out[j]).squaredNorm() < 4.5) out[n++] = out[i] + out[j];
  for (Vec3& v : out) v.normalize();
  return out;
}

/// The directions as structure of arrays.
const std::array<std::array<double, kDirectionBins>, 3> kColumns = [] {
  const std::array<Vec3, kDirectionBins> directions = bin_directions();
  std::array<std::array<double, kDirectionBins>, 3> out;
  for (std::size_t k = 0; k < kDirectionBins; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis][k] = directions[k][static_cast<Eigen::Index>(axis)];
  return out;
}();

}  // namespace

std::size_t nearest_direction_bin(const Vec3& normal) noexcept {
  // All at once, added as in a dot product.
  std::array<double, kDirectionBins> cosine;
  for (std::size_t k = 0; k < kDirectionBins; ++k)
    cosine[k] = (kColumns[0][k] * normal.x() + kColumns[1][k] * normal.y()) + kColumns[2][k] * normal.z();
  std::size_t best = 0;
  for (std::size_t k = 1; k < kDirectionBins; ++k) best = cosine[k] > cosine[best] ? k : best;
  return best;
}

}  // namespace voxtouch::contact
