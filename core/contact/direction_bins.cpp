#include "core/contact/direction_bins.hpp"

#include <array>
#include <numbers>

#include "core/types/clones.hpp"

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
  // Vertices of this icosahedron are 2 apart if they share an edge, and farther otherwise.
  for (std::size_t i = 0; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      if ((out[i] - out[j]).squaredNorm() < 4.5)
        out[n++] = out[i] + out[j];
  for (Vec3& v : out)
    v.normalize();
  return out;
}

/// The directions as structure of arrays.
const std::array<std::array<double, kDirectionBins>, 3> kColumns = [] {
  const std::array<Vec3, kDirectionBins> directions = bin_directions();
  std::array<std::array<double, kDirectionBins>, 3> out;
  for (std::size_t k = 0; k < kDirectionBins; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[axis][k] = directions[k][static_cast<Eigen::Index>(axis)];
  return out;
}();

/// Evaluates one direction after the other for all normals at once, summed as in a dot product.
VOXTOUCH_CLONES void find_nearest(const NormalBlock& __restrict normals,
                                  double (&__restrict cosine)[NormalBlock::kNormals],
                                  double (&__restrict bin)[NormalBlock::kNormals]) noexcept {
  for (std::size_t k = 0; k < kDirectionBins; ++k) {
    const double x = kColumns[0][k], y = kColumns[1][k], z = kColumns[2][k],
                 number = static_cast<double>(k);
    for (std::size_t n = 0; n < normals.count; ++n) {
      const double here =
          (x * normals.along[0][n] + y * normals.along[1][n]) + z * normals.along[2][n];
      bin[n] = here > cosine[n] ? number : bin[n];
      cosine[n] = here > cosine[n] ? here : cosine[n];
    }
  }
}

}  // namespace

void nearest_direction_bins(const NormalBlock& normals,
                            std::uint32_t (&bins)[NormalBlock::kNormals]) noexcept {
  alignas(64) double cosine[NormalBlock::kNormals], bin[NormalBlock::kNormals];
  for (std::size_t n = 0; n < normals.count; ++n)
    cosine[n] = -2.0, bin[n] = 0.0;
  find_nearest(normals, cosine, bin);
  for (std::size_t n = 0; n < normals.count; ++n)
    bins[n] = static_cast<std::uint32_t>(bin[n]);
}

}  // namespace voxtouch::contact
