#include "core/contact/patch_normals.hpp"

#include <numbers>

#include "core/types/smoothstep.hpp"

namespace voxtouch::contact {
namespace {

std::array<Vec3, PatchNormals::kBins> bin_directions() {
  const double g = std::numbers::phi;
  std::array<Vec3, PatchNormals::kBins> out;
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

const std::array<Vec3, PatchNormals::kBins> kDirections = bin_directions();
/// The same as structure of arrays.
const std::array<std::array<double, PatchNormals::kBins>, 3> kColumns = [] {
  std::array<std::array<double, PatchNormals::kBins>, 3> out;
  for (std::size_t k = 0; k < PatchNormals::kBins; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis][k] = kDirections[k][static_cast<Eigen::Index>(axis)];
  return out;
}();
constexpr double kCosWide = 0.6427876096865394, kCosNarrow = 0.984807753012208;  // 50 and 10 degrees

double membership(const Vec3& direction, const Vec3& normal) noexcept {
  const double cosine = direction.dot(normal);
  return cosine <= kCosWide ? 0.0 : smoothstep(kCosWide, kCosNarrow, cosine);
}

}  // namespace

void PatchNormals::add(const Vec3& normal, double weight) noexcept {
  for (std::size_t k = 0; k < kBins; ++k)
    if (const double b = membership(kDirections[k], normal); b > 0.0) sums_[k] += (b * weight) * normal;
}

Vec3 PatchNormals::mean_near(const Vec3& normal) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < kBins; ++k)
    if (const double b = membership(kDirections[k], normal); b > 0.0) sum += b * sums_[k];
  const double length = sum.stableNorm();
  return length > 0.0 ? Vec3(sum / length) : normal;
}

std::size_t PatchNormals::nearest_bin(const Vec3& normal) noexcept {
  // All at once, added as in a dot product.
  std::array<double, kBins> cosine;
  for (std::size_t k = 0; k < kBins; ++k)
    cosine[k] = (kColumns[0][k] * normal.x() + kColumns[1][k] * normal.y()) + kColumns[2][k] * normal.z();
  std::size_t best = 0;
  for (std::size_t k = 1; k < kBins; ++k) best = cosine[k] > cosine[best] ? k : best;
  return best;
}

}  // namespace voxtouch::contact
