#include "core/mesh/weld.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace voxtouch::mesh {
namespace {

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& c) const noexcept {
    std::uint64_t h = 0x9e3779b97f4a7c15u;
    for (const std::int64_t k : c)
      h = (h ^ static_cast<std::uint64_t>(k)) * 0xff51afd7ed558ccdu, h ^= h >> 32;
    return static_cast<std::size_t>(h);
  }
};

/// Standing vertices by cell. A cell is much wider than the tolerance, so that nearly every look-up opens one
/// cell only.
class StandingVertices {
 public:
  StandingVertices(const std::vector<Vec3>& vertices, double tolerance)
      : vertices_(vertices), tolerance_(tolerance), edge_(64.0 * tolerance) {}

  std::uint32_t find_or_add(std::uint32_t vertex) {
    const Vec3& x = vertices_[vertex];
    const Cell low = cell_of(x, -tolerance_), high = cell_of(x, tolerance_);
    std::uint32_t best = vertex;
    for_cells(low, high, [&](const Cell& cell) {
      const auto found = cells_.find(cell);
      if (found == cells_.end()) return;
      for (const std::uint32_t other : found->second) {
        if (other < best && (vertices_[other] - x).cwiseAbs().maxCoeff() <= tolerance_) best = other;
      }
    });
    if (best == vertex) cells_[cell_of(x, 0.0)].push_back(vertex);
    return best;
  }

 private:
  /// Without a tolerance a cell is one number's bits (adding 0.0 turns -0 into 0).
  std::int64_t cell_of(double x, double shift) const {
    if (edge_ > 0.0) return static_cast<std::int64_t>(std::floor((x + shift) / edge_));
    return std::bit_cast<std::int64_t>(x + 0.0);
  }
  Cell cell_of(const Vec3& x, double shift) const {
    return {cell_of(x.x(), shift), cell_of(x.y(), shift), cell_of(x.z(), shift)};
  }
  template <class Visit>
  static void for_cells(const Cell& low, const Cell& high, Visit visit) {
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k) visit(Cell{i, j, k});
  }

  const std::vector<Vec3>& vertices_;
  double tolerance_, edge_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

/// 0 for a mesh whose used vertices all lie in the origin.
double largest_coordinate(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounds(mesh);
  return box.isEmpty() ? 0.0 : std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
}

}  // namespace

std::vector<std::uint8_t> used_vertices(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= used.size())
        throw std::runtime_error(
            fmt::format("triangle {} names vertex {} of {}: the mesh is not complete, build it again", t, v, used.size()));
      used[v] = 1;
    }
  }
  return used;
}

Eigen::AlignedBox3d bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  const std::vector<std::uint8_t> used = used_vertices(mesh);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] && mesh.vertices[v].allFinite()) box.extend(mesh.vertices[v]);
  }
  return box;
}

std::vector<std::uint32_t> standing_vertices(const TriangleMesh& mesh, double tolerance) {
  // Below the rounding of double a tolerance merges nothing that is not equal.
  const double absolute = tolerance < 0x1p-52 ? 0.0 : tolerance * largest_coordinate(mesh);
  StandingVertices standing(mesh.vertices, absolute);
  // Only an unused vertex can lie so far out that the number of its cell is too large; it merges with none.
  const double limit = absolute > 0.0 ? 1e17 * absolute : std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> stands(mesh.vertices.size());
  for (std::uint32_t v = 0; v < stands.size(); ++v) {
    const bool ordinary = mesh.vertices[v].cwiseAbs().maxCoeff() <= limit && mesh.vertices[v].allFinite();
    stands[v] = ordinary ? standing.find_or_add(v) : v;
  }
  return stands;
}

TriangleMesh weld(const TriangleMesh& mesh, double tolerance) {
  const std::vector<std::uint32_t> stands = standing_vertices(mesh, tolerance);
  TriangleMesh welded;
  std::vector<std::uint32_t> fresh(stands.size());
  for (std::uint32_t v = 0; v < stands.size(); ++v) {
    if (stands[v] == v) {
      fresh[v] = static_cast<std::uint32_t>(welded.vertices.size());
      welded.vertices.push_back(mesh.vertices[v]);
    } else {
      fresh[v] = fresh[stands[v]];
    }
  }
  welded.triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) welded.triangles.push_back({fresh[t[0]], fresh[t[1]], fresh[t[2]]});
  return welded;
}

TriangleMesh transform(const TriangleMesh& mesh, double scale, const Pose& pose) {
  TriangleMesh moved = mesh;
  for (Vec3& x : moved.vertices) x = pose * Vec3(scale * x);
  return moved;
}

}  // namespace voxtouch::mesh
