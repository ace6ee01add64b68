#pragma once
/// Signed distances to a closed mesh, fast enough to be asked for a million times.
#include <array>
#include <cstdint>
#include <vector>

#include "core/reference/inside_test.hpp"
#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

/// Triangles in a tree of boxes. The sign is that of the nearest feature: the face's normal, or the
/// angle-weighted pseudonormal of edge or vertex (Baerentzen and Aanaes 2005). That needs a surface
/// without borders that does not cross itself, which the constructor checks: two triangles at each
/// edge, one fan at each vertex, no edge through another triangle, and agreement with the winding
/// number next to the middles of up to kTestedFaces faces. Else the winding number gives all signs
/// (InsideTest).
class SignedSurface {
 public:
  static constexpr std::size_t kTestedFaces = 2000;

  /// Copies what it needs; the mesh may go. Throws std::invalid_argument where the mesh is not
  /// closed: it has no inside.
  explicit SignedSurface(const ReferenceMesh& mesh);

  /// Of `x` in the mesh's frame [m], negative inside. `hint`: kNoHint, or what the last query close
  /// by left there, which makes this one faster and changes what it gives by no more than rounding.
  /// Does not allocate; const, may run at once.
  double distance(const Vec3& x, std::uint32_t& hint) const noexcept;
  static constexpr std::uint32_t kNoHint = 0xffffffff;

  /// False: this mesh needs winding numbers.
  bool sign_by_feature() const noexcept { return by_feature_; }

 private:
  using Corners = std::array<Vec3, 3>;
  struct Node {
    Vec3 low, high;
    std::uint32_t first =
        0;  ///< triangle of a leaf; else the second child, the first follows its parent
    std::uint32_t count = 0;  ///< triangles of a leaf, 0 inside the tree
  };
  /// The nearest point and which feature it lies on: 0 the face; 1, 2, 3 the edges from corner 0,
  /// 1, 2; 4, 5, 6 the corners.
  struct Nearest {
    double square = 0.0;
    Vec3 point = Vec3::Zero();
    std::uint32_t triangle = kNoHint, feature = 0;
  };

  static Nearest on_triangle(const Corners& t, const Vec3& x) noexcept;
  Nearest nearest(const Vec3& x, std::uint32_t hint) const noexcept;
  void build(std::vector<std::uint32_t>& order, std::uint32_t first, std::uint32_t last,
             const std::vector<Corners>& all);
  bool crosses_itself(const ReferenceMesh& mesh, const std::vector<std::uint32_t>& order) const;
  bool agrees_with_winding() const;

  std::vector<Corners> triangles_;  ///< in the tree's order
  std::vector<std::array<Vec3, 7>>
      normals_;  ///< of each feature, outward, not of unit length; empty without `by_feature_`
  std::vector<Node> nodes_;  ///< depth first
  InsideTest inside_;
  bool by_feature_ = false;
};

}  // namespace voxtouch::reference
