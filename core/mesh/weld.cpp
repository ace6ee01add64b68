#include "core/mesh/weld.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace voxtouch::mesh {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// Three numbers that are a place, in one; open addressing needs the low bits spread.
using Cell = std::array<std::int64_t, 3>;
std::uint64_t hash_of(const Cell& c) noexcept {
  std::uint64_t h = 0x9e3779b97f4a7c15u;
  for (const std::int64_t k : c)
    h = (h ^ static_cast<std::uint64_t>(k)) * 0xff51afd7ed558ccdu, h ^= h >> 32;
  return h;
}

/// The lowest-numbered vertex at exactly the same position, for vertices queried in order.
class EqualVertices {
 public:
  explicit EqualVertices(const std::vector<Vec3>& vertices)
      : vertices_(vertices),
        table_(std::bit_ceil(2 * vertices.size() + 2), kNone) {}

  std::uint32_t find_or_add(std::uint32_t vertex) {
    const Cell own = bits(vertices_[vertex]);
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = hash_of(own) & mask;
    while (table_[slot] != kNone && vertices_[table_[slot]] != vertices_[vertex])
      slot = (slot + 1) & mask;
    if (table_[slot] == kNone)
      table_[slot] = vertex;
    return table_[slot];
  }

 private:
  static Cell bits(const Vec3& x) noexcept {  // adding 0.0 changes -0 to 0
    return {std::bit_cast<std::int64_t>(x.x() + 0.0), std::bit_cast<std::int64_t>(x.y() + 0.0),
            std::bit_cast<std::int64_t>(x.z() + 0.0)};
  }
  const std::vector<Vec3>& vertices_;
  std::vector<std::uint32_t> table_;
};

/// Representative vertices by cell. A cell is much larger than the tolerance, so nearly every query
/// reads one cell only.
class StandingVertices {
 public:
  StandingVertices(const std::vector<Vec3>& vertices, double tolerance)
      : vertices_(vertices),
        tolerance_(tolerance),
        edge_(64.0 * tolerance),
        table_(1024),
        next_(vertices.size(), kNone) {}

  std::uint32_t find_or_add(std::uint32_t vertex) {
    const Vec3& x = vertices_[vertex];
    std::uint32_t best = vertex;
    for_cells(cell_of(x, -tolerance_), cell_of(x, tolerance_), [&](const Cell& cell) {
      for (std::uint32_t other = table_[slot_of(cell)].last; other != kNone; other = next_[other])
        if (other < best && (vertices_[other] - x).cwiseAbs().maxCoeff() <= tolerance_)
          best = other;
    });
    if (best == vertex)
      add(vertex, cell_of(x, 0.0));
    return best;
  }

 private:
  /// The vertices of one cell are a chain from the last to the first of them.
  struct Slot {
    std::uint32_t last = kNone;
    std::uint32_t hash = 0;  ///< upper half of the cell's
  };

  std::int64_t cell_of(double x, double shift) const {
    return static_cast<std::int64_t>(std::floor((x + shift) / edge_));
  }
  Cell cell_of(const Vec3& x, double shift) const {
    return {cell_of(x.x(), shift), cell_of(x.y(), shift), cell_of(x.z(), shift)};
  }
  template <class Visit>
  static void for_cells(const Cell& low, const Cell& high, Visit visit) {
    for (std::int64_t i = low[0]; i <= high[0]; ++i)
      for (std::int64_t j = low[1]; j <= high[1]; ++j)
        for (std::int64_t k = low[2]; k <= high[2]; ++k)
          visit(Cell{i, j, k});
  }

  /// The slot of the cell, or the free one for it.
  std::size_t slot_of(const Cell& cell) const {
    const std::uint64_t hash = hash_of(cell);
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = hash & mask;
    while (table_[slot].last != kNone &&
           (table_[slot].hash != hash >> 32 || cell_of(vertices_[table_[slot].last], 0.0) != cell))
      slot = (slot + 1) & mask;
    return slot;
  }
  void add(std::uint32_t vertex, const Cell& cell) {
    Slot& slot = table_[slot_of(cell)];
    if (slot.last == kNone && ++cells_ * 2 > table_.size()) {
      grow();
      return void(
          table_[slot_of(cell)] = {vertex, static_cast<std::uint32_t>(hash_of(cell) >> 32)});
    }
    next_[vertex] = slot.last;
    slot = {vertex, static_cast<std::uint32_t>(hash_of(cell) >> 32)};
  }
  void grow() {
    std::vector<Slot> before(2 * table_.size());
    before.swap(table_);
    for (const Slot& slot : before)
      if (slot.last != kNone)
        table_[slot_of(cell_of(vertices_[slot.last], 0.0))] = slot;
  }

  const std::vector<Vec3>& vertices_;
  double tolerance_, edge_;
  std::vector<Slot> table_;
  std::vector<std::uint32_t> next_;
  std::size_t cells_ = 0;
};

/// 0 for a mesh with all used vertices at the origin.
double largest_coordinate(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounds(mesh);
  return box.isEmpty() ? 0.0
                       : std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
}

}  // namespace

std::vector<std::uint8_t> used_vertices(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= used.size())
        throw std::runtime_error(fmt::format(
            "triangle {} has vertex index {} of {}: the mesh is incomplete, build it again", t, v,
            used.size()));
      used[v] = 1;
    }
  }
  return used;
}

Eigen::AlignedBox3d bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  const std::vector<std::uint8_t> used = used_vertices(mesh);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] && mesh.vertices[v].allFinite())
      box.extend(mesh.vertices[v]);
  }
  return box;
}

std::vector<std::uint32_t> standing_vertices(const TriangleMesh& mesh, double tolerance) {
  // Below the rounding of double a tolerance merges nothing that is not equal.
  const double absolute = tolerance < 0x1p-52 ? 0.0 : tolerance * largest_coordinate(mesh);
  EqualVertices equal(mesh.vertices);
  std::optional<StandingVertices> standing;
  if (absolute > 0.0)
    standing.emplace(mesh.vertices, absolute);
  // Only an unused vertex can lie so far out that the number of its cell is too large; it merges
  // with none.
  const double limit = absolute > 0.0 ? 1e17 * absolute : std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> stands(mesh.vertices.size());
  for (std::uint32_t v = 0; v < stands.size(); ++v) {
    const bool ordinary =
        mesh.vertices[v].cwiseAbs().maxCoeff() <= limit && mesh.vertices[v].allFinite();
    const std::uint32_t first = ordinary ? equal.find_or_add(v) : v;
    // The representative of the first vertex at a position represents all of them: vertices in
    // between have higher numbers.
    if (first != v)
      stands[v] = stands[first];
    else
      stands[v] = ordinary && standing ? standing->find_or_add(v) : v;
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
  for (const auto& t : mesh.triangles)
    welded.triangles.push_back({fresh[t[0]], fresh[t[1]], fresh[t[2]]});
  return welded;
}

std::size_t remove_collapsed(TriangleMesh& welded) {
  return std::erase_if(welded.triangles,
                       [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

TriangleMesh transform(const TriangleMesh& mesh, double scale, const Pose& pose) {
  TriangleMesh moved = mesh;
  for (Vec3& x : moved.vertices)
    x = pose * Vec3(scale * x);
  return moved;
}

}  // namespace voxtouch::mesh
