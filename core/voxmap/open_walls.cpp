#include "core/voxmap/open_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace voxtouch::voxmap {
namespace {

/// How far beyond an edge it is looked whether the surface goes on, and how near it must come there [voxels].
constexpr double kBeyond = 0.75, kGoesOn = 0.5;

struct Edge {
  std::uint32_t low, high, triangle;
  bool operator<(const Edge& other) const noexcept { return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle); }
  bool same_place(const Edge& other) const noexcept { return low == other.low && high == other.high; }
};

/// Edges that one triangle alone has.
std::vector<Edge> borders(const GridMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  const std::vector<std::uint32_t> welded = weld_vertices(mesh);
  std::vector<Edge> edges;
  for (const std::uint32_t t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(welded[(*mesh.triangles)[t][k]], welded[(*mesh.triangles)[t][(k + 1) % 3]]);
      edges.push_back({low, high, t});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> out;
  for (std::size_t n = 0; n < edges.size(); ++n)
    if (!(n > 0 && edges[n].same_place(edges[n - 1])) && !(n + 1 < edges.size() && edges[n].same_place(edges[n + 1]))) out.push_back(edges[n]);
  return out;
}

/// The rims in pieces of a voxel at most.
mesh::TriangleMesh rim_edges(const ClosedMesh& of, const DistanceTree& faces) {
  const GridMesh& mesh = of.in_grid;
  mesh::TriangleMesh rims;
  for (const Edge& edge : borders(mesh, of.shells.open)) {
    const Vec3 &from = mesh.u[edge.low], &to = mesh.u[edge.high];
    const Vec3 along = (to - from).stableNormalized();
    const Vec3 inward = (mesh.corner(edge.triangle, 0) + mesh.corner(edge.triangle, 1) + mesh.corner(edge.triangle, 2)) / 3.0 - from;
    const Vec3 outward = (inward.dot(along) * along - inward).stableNormalized();
    const double pieces = std::ceil((to - from).norm());
    for (double n = 0.0; n < pieces; ++n) {
      const Vec3 a = from + n / pieces * (to - from), b = from + (n + 1.0) / pieces * (to - from);
      std::uint32_t open = DistanceTree::kNoPlace, closed = DistanceTree::kNoPlace;
      if (faces.nearest(0.5 * (a + b) + kBeyond * outward, kGoesOn, open) < kGoesOn || of.tree.nearest(0.5 * (a + b), kGoesOn, closed) < kGoesOn) continue;
      const auto first = static_cast<std::uint32_t>(rims.vertices.size());
      rims.vertices.push_back(a), rims.vertices.push_back(b);
      rims.triangles.push_back({first, first + 1, first});
    }
  }
  return rims;
}

DistanceTree over_all(const mesh::TriangleMesh& edges) {
  std::vector<std::uint32_t> all(edges.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  return {GridMesh(edges, Grid{Vec3::Zero(), 1.0}), all};
}

}  // namespace

OpenWalls::OpenWalls(const ClosedMesh& mesh, bool wanted)
    : any_(wanted && !mesh.shells.open.empty()), faces_(mesh.in_grid, any_ ? mesh.shells.open : std::vector<std::uint32_t>{}),
      rims_(over_all(any_ ? rim_edges(mesh, faces_) : mesh::TriangleMesh{})) {}

}  // namespace voxtouch::voxmap
