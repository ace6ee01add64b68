#pragma once
/// Inside test of a point by the generalised winding number (Jacobson, Kavan, Sorkine-Hornung
/// 2013), which is robust against cracks. Distant parts of the mesh are approximated by one dipole
/// each (Barill et al. 2018), and refined where needed.
#include <cstdint>
#include <vector>

#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

class InsideTest {
 public:
  /// Copies the mesh data; the mesh need not outlive it.
  explicit InsideTest(const ReferenceMesh& mesh);

  /// Whether |winding number| > 1/2, for `x` in the mesh's frame. Exact up to the surface for a
  /// closed mesh; an inverted mesh has the same interior. Does not allocate. Sums run in a fixed
  /// order, so results are bit-identical.
  bool inside(const Vec3& x) const noexcept;

  /// The exact sum over all triangles (Van Oosterom and Strackee 1983): 1 inside a closed mesh, 0
  /// outside, fractional for an open one. Visits all triangles.
  double winding_number(const Vec3& x) const noexcept;
  /// The sum with distant parts as dipoles, with which `inside` starts. Within 0.05 of the exact
  /// sum on closed meshes (tested).
  double winding_estimate(const Vec3& x) const noexcept;

 private:
  struct Triangle {
    Vec3 a, b, c;
  };
  struct Node {
    Vec3 centre = Vec3::Zero();  ///< area-weighted
    Vec3 area = Vec3::Zero();    ///< sum of area vectors
    double radius = 0.0;         ///< of the ball around `centre` that contains all corners
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
