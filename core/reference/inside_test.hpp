#pragma once
/// Is a point inside a mesh? By the generalised winding number (Jacobson, Kavan, Sorkine-Hornung
/// 2013), which does not mind cracks; far parts of the mesh count as one dipole each (Barill et al.
/// 2018), refined where that could matter.
#include <cstdint>
#include <vector>

#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

class InsideTest {
 public:
  /// Copies what it needs; the mesh may go.
  explicit InsideTest(const ReferenceMesh& mesh);

  /// Whether |winding number| > 1/2, for `x` in the mesh's frame. Right up to the surface for a
  /// closed mesh. A mesh turned inside out has the same inside. Does not allocate. Sums run in a
  /// fixed order: bit-identical everywhere.
  bool inside(const Vec3& x) const noexcept;

  /// The exact sum over all triangles (Van Oosterom and Strackee 1983): 1 inside a closed mesh, 0
  /// outside, fractions where it is open. Costs all triangles.
  double winding_number(const Vec3& x) const noexcept;
  /// The sum with far parts as dipoles: what `inside` starts with. Within 0.05 of the exact sum on
  /// closed meshes (tested).
  double winding_estimate(const Vec3& x) const noexcept;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 centre = Vec3::Zero();  ///< area-weighted
    Vec3 area = Vec3::Zero();    ///< sum of area vectors
    double radius = 0.0;         ///< of the ball round `centre` that holds all corners
    std::uint32_t first = 0, last = 0,
                  skip = 0;  ///< triangles [first, last); `skip`: next node if this one is done
  };
  void build(std::uint32_t first, std::uint32_t last);
  static double solid_angle(const Triangle& t, const Vec3& x) noexcept;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  ///< depth first
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
};

}  // namespace voxtouch::reference
