#pragma once
/// Signed distances to a closed mesh, fast enough for millions of queries.
#include <array>
#include <cstdint>
#include <vector>

#include "core/reference/inside_test.hpp"
#include "core/reference/reference_mesh.hpp"

namespace voxtouch::reference {

/// Triangles in a tree of boxes. The sign is that of the nearest feature: the normal of a face, or
/// the angle-weighted pseudonormal of an edge or vertex (Baerentzen and Aanaes 2005).
/// This requires a surface without borders and self-intersections. The constructor checks for two
/// triangles at each edge, one fan at each vertex and no edge through another triangle. It also
/// compares the sign with the winding number next to the centres of up to kTestedFaces faces.
/// Otherwise the winding number gives all signs (InsideTest).
class SignedSurface {
 public:
  static constexpr std::size_t kTestedFaces = 2000;

  /// Copies the mesh data; the mesh need not outlive it. Throws std::invalid_argument for an open
  /// mesh, which has no interior.
  explicit SignedSurface(const ReferenceMesh& mesh);

  /// Signed distance of `x` in the mesh's frame [m], negative inside. `hint`: kNoHint, or the value
  /// from the last nearby query, which speeds up this one and changes the result by rounding only.
  /// Does not allocate; const, may run concurrently.
  double distance(const Vec3& x, std::uint32_t& hint) const noexcept;
  static constexpr std::uint32_t kNoHint = 0xffffffff;

  /// False: this mesh needs winding numbers.
  bool sign_by_feature() const noexcept { return by_feature_; }

 private:
  using Corners = std::array<Vec3, 3>;
  struct Node {
    Vec3 low, high;
    std::uint32_t first = 0;  ///< First triangle of a leaf; otherwise the second child (the first
                              ///< follows its parent).
    std::uint32_t count = 0;  ///< number of triangles of a leaf, 0 for inner nodes
  };
  /// The nearest point and its feature: 0 the face; 1, 2, 3 the edges from corner 0, 1, 2; 4, 5, 6
  /// the corners.
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
