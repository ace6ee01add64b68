#pragma once
/// The kind of each triangle of a mesh, and the neighbours at its edges; used by report.hpp.
#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::mesh {

enum class TriangleKind : std::uint8_t {
  kSound,      ///< has an area, finite corners, and is the first with its three corners
  kZeroArea,   ///< two corners coincide, or the three lie on one line within the rounding of double
  kDuplicate,  ///< same corners as a previous valid triangle, same orientation
  kOppositeDuplicate,  ///< same corners as a previous valid triangle, opposite orientation
  kNotFinite           ///< a corner is NaN or Inf
};

/// The kind of each triangle; `stands` as standing_vertices() gives it.
std::vector<TriangleKind> triangle_kinds(const TriangleMesh& mesh,
                                         const std::vector<std::uint32_t>& stands);

/// One side of a triangle, corners in ascending order.
struct Side {
  std::uint32_t low = 0, high = 0;
  std::uint32_t triangle = 0;
  bool forward = true;  ///< the triangle walks from `low` to `high`
};

/// The sides of the triangles in `which`, sorted by (low, high, triangle): the sides of one edge
/// are adjacent. Sides with equal ends are skipped.
std::vector<Side> sorted_sides(const TriangleMesh& mesh, const std::vector<std::uint32_t>& stands,
                               const std::vector<std::uint32_t>& which);

/// Calls visit(first, last) for each run of sides with one (low, high).
template <class Visit>
void for_edges(const std::vector<Side>& sides, Visit visit) {
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    const auto same = [&](const Side& s) {
      return s.low == sides[first].low && s.high == sides[first].high;
    };
    while (last < sides.size() && same(sides[last]))
      ++last;
    visit(first, last);
    first = last;
  }
}

/// Parts of a surface and the orientation of each triangle, found by walking over the edges of
/// exactly two triangles.
struct Orientation {
  std::vector<std::uint32_t>
      part;  ///< of each entry of `which`; parts count from their lowest triangle
  std::vector<std::uint8_t> against;  ///< 1: against most of its part
  std::size_t parts = 0;
  bool orientable = true;  ///< false: a part has one side only (a Moebius strip)
};
Orientation orientation_of(const std::vector<Side>& sides, const std::vector<std::uint32_t>& which,
                           std::size_t triangles);

}  // namespace voxtouch::mesh
