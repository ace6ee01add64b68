#pragma once
/// Triangles in a tree of boxes, for nearest distances and ray candidates. All in grid coordinates.
/// For building only.
#include <array>
#include <cstdint>
#include <vector>

#include "core/voxmap/grid_mesh.hpp"

namespace voxtouch::voxmap {

/// Queries are const, may run concurrently and give bit-identical results in any order.
class DistanceTree {
 public:
  /// Tree over the triangles in `chosen`, whose numbers `each_on_ray` returns. If empty, every
  /// distance is the bound.
  DistanceTree(const GridMesh& mesh, const std::vector<std::uint32_t>& chosen);

  /// Distance [voxels] from `p` to the nearest triangle, or `bound` if none is nearer.
  /// The nearest point of a triangle is that of its plane if it lies within all three edges, else
  /// the nearest of the edges that `p` lies beyond. A triangle without area consists of its edges.
  /// `place`: position in this tree of the triangle nearest to a nearby point, initially kNoPlace;
  /// it speeds up the search without changing the result. It receives that of the triangle found.
  double nearest(const Vec3& p, double bound, std::uint32_t& place) const noexcept;
  static constexpr std::uint32_t kNoPlace = 0xffffffff;

  /// Many points as structure of arrays.
  struct Points {
    static constexpr std::size_t kCount = 32;
    std::array<double, kCount> x{}, y{}, z{};
    void set(std::size_t n, const Vec3& p) noexcept { x[n] = p.x(), y[n] = p.y(), z[n] = p.z(); }
  };
  using Squares = std::array<double, Points::kCount>;
  /// The displacement to `p` from the nearest point of the triangle at this place, accurate to
  /// rounding.
  Vec3 displacement(std::uint32_t place, const Vec3& p) const noexcept;
  /// Squared distance of each point to the triangle at this place, bit-identical to the values that
  /// `nearest` compares.
  void squares(std::uint32_t place, const Points& points, Squares& out) const noexcept;
  /// Places of all triangles within `reach` of `centre`, and some beyond, in the order of the tree;
  /// at most `most`. Returns false if there are more.
  bool within(const Vec3& centre, double reach, std::size_t most,
              std::vector<std::uint32_t>& places) const;

  /// Calls f(triangle) for each triangle whose box meets the line from `origin` along `direction`,
  /// of any length.
  template <class F>
  void each_on_ray(const Vec3& origin, const Vec3& direction, F&& f) const;

 private:
  struct Facet {
    std::array<Vec3, 3> corner, edge,
        outward;  ///< outward: in the plane, away from the triangle, for each edge
    /// Of the edges' lengths; 0 for an edge without length.
    std::array<double, 3> inverse_square;
    Vec3 normal;  ///< unit; zero for a triangle without area
    std::uint32_t triangle;
  };
  struct Node {
    Vec3 low, high;
    /// First facet of a leaf; otherwise the second child (the first follows its parent).
    std::uint32_t first;
    std::uint32_t count;  ///< number of facets of a leaf, 0 for inner nodes
  };
  static constexpr std::uint32_t kLeafFacets = 4;
  static constexpr std::size_t kDeepest = 64;  ///< halving 2^32 facets takes fewer levels

  static Facet make_facet(const GridMesh& mesh, std::uint32_t triangle);
  /// Calls f(displacement from the edge) for each edge that `p` lies beyond. Returns false if there
  /// is none: the projection on the plane is nearest.
  template <class F>
  static bool each_edge_before(const Facet& facet, const Vec3& p, F&& f) noexcept;
  static double square_distance(const Facet& facet, const Vec3& p) noexcept;
  static double square_distance(const Node& node, const Vec3& p) noexcept;
  static bool on_ray(const Node& node, const Vec3& origin, const Vec3& direction) noexcept;
  /// Position of a triangle during construction.
  struct Place {
    Vec3 three_middles;  ///< sum of its corners
    std::uint32_t triangle;
  };
  /// Calls leaf(node) for each leaf in the order of the tree, only below nodes with meets(node);
  /// ends when leaf returns false.
  template <class Meets, class Leaf>
  bool each_leaf(const Meets& meets, const Leaf& leaf) const;
  void split(std::vector<Place>& places, std::uint32_t begin, std::uint32_t end);
  /// Computes the box of a node from those of its children.
  void enclose(std::size_t index) noexcept;

  std::vector<Facet> facets_;
  std::vector<Node> nodes_;
};

template <class Meets, class Leaf>
bool DistanceTree::each_leaf(const Meets& meets, const Leaf& leaf) const {
  if (nodes_.empty())
    return true;
  std::array<std::uint32_t, kDeepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!meets(node))
      continue;
    if (node.count == 0)
      stack[depth++] = node.first, stack[depth++] = index + 1;
    else if (!leaf(node))
      return false;
  }
  return true;
}

template <class F>
void DistanceTree::each_on_ray(const Vec3& origin, const Vec3& direction, F&& f) const {
  each_leaf([&](const Node& node) { return on_ray(node, origin, direction); },
            [&](const Node& leaf) {
              for (std::uint32_t n = 0; n < leaf.count; ++n)
                f(facets_[leaf.first + n].triangle);
              return true;
            });
}

}  // namespace voxtouch::voxmap
