#include "core/mesh/topology.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace voxtouch::mesh {
namespace {

/// Corners count as collinear if twice the area is below the possible rounding error: of the
/// coordinates (largest |coordinate| times eps, once per difference) and of the products.
bool zero_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  const Vec3 u = b - a, v = c - a;
  const double largest = a.cwiseAbs().cwiseMax(b.cwiseAbs()).cwiseMax(c.cwiseAbs()).maxCoeff();
  const double lu = u.norm(), lv = v.norm();
  return u.cross(v).norm() <= kRounding * (lu * lv + largest * (lu + lv));
}

struct Corners {
  std::array<std::uint32_t, 3> sorted{};
  std::uint32_t triangle = 0;
  bool even = true;  ///< the triangle is an even permutation of its sorted corners
};

Corners corners_of(const std::array<std::uint32_t, 3>& t, std::uint32_t triangle) {
  Corners c{t, triangle, true};
  const auto order = [&](std::size_t i, std::size_t j) {
    if (c.sorted[j] < c.sorted[i])
      std::swap(c.sorted[i], c.sorted[j]), c.even = !c.even;
  };
  order(0, 1), order(1, 2), order(0, 1);
  return c;
}

/// Sorts by a vertex number below `vertices`, which `vertex_of` returns, then by `less`.
template <class T, class VertexOf, class Less>
void sort_by_vertex(std::vector<T>& values, std::size_t vertices, VertexOf vertex_of, Less less) {
  std::vector<std::size_t> start(vertices + 1, 0);
  for (const T& value : values)
    ++start[vertex_of(value) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<T> sorted(values.size());
  for (const T& value : values)
    sorted[start[vertex_of(value)]++] = value;  // each start ends as the one behind it
  values.swap(sorted);
  for (std::size_t v = 0, first = 0; v < vertices; first = start[v++])
    if (start[v] - first > 1)
      std::sort(values.begin() + static_cast<std::ptrdiff_t>(first),
                values.begin() + static_cast<std::ptrdiff_t>(start[v]), less);
}

std::array<std::uint32_t, 3> standing(const TriangleMesh& mesh,
                                      const std::vector<std::uint32_t>& stands, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return {stands[c[0]], stands[c[1]], stands[c[2]]};
}

}  // namespace

std::vector<TriangleKind> triangle_kinds(const TriangleMesh& mesh,
                                         const std::vector<std::uint32_t>& stands) {
  std::vector<TriangleKind> kinds(mesh.triangles.size(), TriangleKind::kSound);
  std::vector<Corners> corners;
  corners.reserve(kinds.size());
  for (std::uint32_t t = 0; t < kinds.size(); ++t) {
    const auto s = standing(mesh, stands, t);
    const Vec3 &a = mesh.vertices[s[0]], &b = mesh.vertices[s[1]], &c = mesh.vertices[s[2]];
    if (!a.allFinite() || !b.allFinite() || !c.allFinite()) {
      kinds[t] = TriangleKind::kNotFinite;
    } else if (s[0] == s[1] || s[1] == s[2] || s[2] == s[0] || zero_area(a, b, c)) {
      kinds[t] = TriangleKind::kZeroArea;
    } else {
      corners.push_back(corners_of(s, t));
    }
  }
  sort_by_vertex(
      corners, mesh.vertices.size(), [](const Corners& c) { return c.sorted[0]; },
      [](const Corners& a, const Corners& b) {
        return std::tie(a.sorted, a.triangle) < std::tie(b.sorted, b.triangle);
      });
  for (std::size_t k = 1, first = 0; k < corners.size(); ++k) {
    if (corners[k].sorted != corners[first].sorted) {
      first = k;
    } else {
      const bool same_direction = corners[k].even == corners[first].even;
      kinds[corners[k].triangle] =
          same_direction ? TriangleKind::kDuplicate : TriangleKind::kOppositeDuplicate;
    }
  }
  return kinds;
}

std::vector<Side> sorted_sides(const TriangleMesh& mesh, const std::vector<std::uint32_t>& stands,
                               const std::vector<std::uint32_t>& which) {
  std::vector<Side> sides;
  sides.reserve(3 * which.size());
  for (const std::uint32_t t : which) {
    const auto s = standing(mesh, stands, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = s[k], to = s[(k + 1) % 3];
      if (from != to)
        sides.push_back({std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  sort_by_vertex(
      sides, mesh.vertices.size(), [](const Side& s) { return s.low; },
      [](const Side& a, const Side& b) {
        return std::tie(a.high, a.triangle) < std::tie(b.high, b.triangle);
      });
  return sides;
}

namespace {

struct Neighbour {
  std::uint32_t triangle;
  bool flipped;  ///< both triangles use the edge in the same direction, so one of them is flipped
};
constexpr Neighbour kNoNeighbour{~std::uint32_t{0}, false};

/// Over the edges of exactly two triangles.
std::vector<std::array<Neighbour, 3>> neighbours_of(const std::vector<Side>& sides,
                                                    std::size_t triangles) {
  std::vector<std::array<Neighbour, 3>> neighbours(triangles,
                                                   {kNoNeighbour, kNoNeighbour, kNoNeighbour});
  const auto add = [&](std::uint32_t t, Neighbour n) {
    for (Neighbour& free : neighbours[t]) {
      if (free.triangle == kNoNeighbour.triangle)
        return void(free = n);
    }
  };
  for_edges(sides, [&](std::size_t first, std::size_t last) {
    if (last - first != 2)
      return;
    const Side &a = sides[first], &b = sides[first + 1];
    add(a.triangle, {b.triangle, a.forward == b.forward});
    add(b.triangle, {a.triangle, a.forward == b.forward});
  });
  return neighbours;
}

}  // namespace

Orientation orientation_of(const std::vector<Side>& sides, const std::vector<std::uint32_t>& which,
                           std::size_t triangles) {
  const std::vector<std::array<Neighbour, 3>> neighbours = neighbours_of(sides, triangles);
  Orientation result;
  constexpr std::uint32_t kNoPart = ~std::uint32_t{0};
  std::vector<std::uint32_t> part(triangles, kNoPart), walk;
  std::vector<std::uint8_t> flipped(triangles, 0);
  for (const std::uint32_t seed : which) {
    if (part[seed] != kNoPart)
      continue;
    const auto number = static_cast<std::uint32_t>(result.parts++);
    part[seed] = number;
    walk.assign(1, seed);
    std::size_t against = 0;
    for (std::size_t head = 0; head < walk.size(); ++head) {
      const std::uint32_t t = walk[head];
      against += flipped[t];
      for (const Neighbour& n : neighbours[t]) {
        if (n.triangle == kNoNeighbour.triangle)
          continue;
        const auto expected =
            static_cast<std::uint8_t>(flipped[t] ^ static_cast<std::uint8_t>(n.flipped));
        if (part[n.triangle] == kNoPart) {
          part[n.triangle] = number;
          flipped[n.triangle] = expected;
          walk.push_back(n.triangle);
        } else if (flipped[n.triangle] != expected) {
          result.orientable = false;
        }
      }
    }
    if (2 * against > walk.size()) {  // most disagree with the seed: then the seed is flipped
      for (const std::uint32_t t : walk)
        flipped[t] ^= 1;
    }
  }
  for (const std::uint32_t t : which)
    result.part.push_back(part[t]), result.against.push_back(flipped[t]);
  return result;
}

}  // namespace voxtouch::mesh
