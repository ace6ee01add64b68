#pragma once
/// A triangle mesh as features that can touch: faces, edges with their kind, vertices with their
/// edges.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.hpp"

namespace voxtouch::exact {

inline constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// A triangle, counter-clockwise seen from outside.
struct Face {
  std::array<std::uint32_t, 3> corners{};  ///< indices of points
  std::array<std::uint32_t, 3> edges{};    ///< edge k joins corner k and the next one
  Vec3 normal = Vec3::Zero();              ///< unit, outward
  std::uint32_t part = 0;
  std::uint32_t triangle = 0;  ///< of the mesh that it was built from
  bool two_sided = false;      ///< its part is open: both sides hold
};

/// Rims are edges of one face only, and each face's own where three or more meet.
enum class EdgeKind : std::uint8_t { kFlat, kConvex, kConcave, kRim };

struct Edge {
  std::array<std::uint32_t, 2> ends{};   ///< indices of points
  std::array<std::uint32_t, 2> faces{};  ///< the second is kNone at a rim
  std::array<Vec3, 2>
      inward{};  ///< unit, in the face's plane, away from the edge; zero where no face is
  EdgeKind kind = EdgeKind::kFlat;
  bool covered = false;  ///< by another part, in part or whole: it faces no point

  bool makes_rows() const noexcept { return kind == EdgeKind::kConvex || kind == EdgeKind::kRim; }
  /// The face on the other side; kNone at a rim.
  std::uint32_t across(std::uint32_t face) const noexcept {
    return faces[0] == face ? faces[1] : faces[0];
  }
};

struct Vertex {
  std::uint32_t first_direction = 0, directions = 0;  ///< range in FeatureMesh::directions
  std::uint32_t face = kNone;  ///< the lowest-numbered face that has it; kNone: no face does
  bool makes_rows = false;     ///< some edge at it is convex or a rim
  bool covered = false;        ///< by another part: it faces no point
};

/// Connected over edges that two faces share.
struct Part {
  bool closed = true;
  std::uint32_t vertex = kNone;  ///< one of its points
};

/// Lengths in metres, in the mesh's own frame. Immutable once built.
struct FeatureMesh {
  std::vector<Vec3> points;
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<Vertex> vertices;  ///< one a point
  std::vector<Vec3> directions;  ///< unit, from a vertex along each edge at it
  std::vector<Part> parts;
  std::vector<std::uint32_t> row_edges, row_vertices;  ///< that make rows, ascending
  double reach_m = 0.0;  ///< largest distance of a used point from the origin

  std::span<const Vec3> directions_of(std::uint32_t vertex) const noexcept {
    const Vertex& v = vertices[vertex];
    return {directions.data() + v.first_direction, v.directions};
  }
  std::size_t bytes() const noexcept {
    return (points.size() + directions.size()) * sizeof(Vec3) + faces.size() * sizeof(Face) +
           edges.size() * sizeof(Edge) + vertices.size() * sizeof(Vertex) +
           (row_edges.size() + row_vertices.size()) * sizeof(std::uint32_t);
  }
  const Vec3& corner(std::uint32_t face, std::size_t k) const noexcept {
    return points[faces[face].corners[k]];
  }
};

/// Welds `mesh`, leaves out triangles without area, with corners that are not finite, and doubles
/// of either orientation, and finds the features of the rest. Coplanar faces are merged in effect:
/// what lies between them makes no row. Throws std::runtime_error where a triangle names no vertex,
/// or none is left. Allocates.
FeatureMesh find_features(const mesh::TriangleMesh& mesh);

}  // namespace voxtouch::exact
