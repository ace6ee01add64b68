#pragma once
/// Mean normals of patches, without ever saying where one patch ends: so nothing jumps when one splits.
#include <array>
#include <cstddef>

#include "core/types/geometry.hpp"

namespace voxtouch::contact {

/// The sphere of directions in soft bins: 42 of them, the vertices and edge middles of an icosahedron, 31 to 36 degrees apart, fixed
/// in W. A normal belongs to bin k by b_k(n) = smoothstep(cos 50 deg, cos 10 deg; n . v_k), to three or more of them. Two
/// normals less than some 30 degrees apart so share all their bins, two more than 100 degrees apart none.
/// Fixed size, about 1 kB; real-time safe.
class PatchNormals {
 public:
  static constexpr std::size_t kBins = 42;

  /// Adds a normal (unit) with its weight.
  void add(const Vec3& normal, double weight) noexcept;
  /// The unit mean of the patch that `normal` lies in: sum_k b_k(normal) M_k, M_k = sum_j b_k(n_j) w_j n_j. `normal` itself
  /// where that vanishes.
  Vec3 mean_near(const Vec3& normal) const noexcept;
  /// The bin whose direction is nearest to `normal`.
  static std::size_t nearest_bin(const Vec3& normal) noexcept;

 private:
  std::array<Vec3, kBins> sums_ = zeros();
  static std::array<Vec3, kBins> zeros() noexcept {
    std::array<Vec3, kBins> out;
    out.fill(Vec3::Zero());
    return out;
  }
};

}  // namespace voxtouch::contact
