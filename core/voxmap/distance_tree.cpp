#include "core/voxmap/distance_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

/// A box is passed over only if it is farther than the best so far by more than what rounding can do: so the least of all
/// computed distances comes out, whatever the order of the boxes.
constexpr double kRoundingRelative = 1e-6, kRoundingAbsolute = 1e-9;

}  // namespace

DistanceTree::DistanceTree(const GridMesh& mesh, const std::vector<std::uint32_t>& chosen) {
  facets_.reserve(chosen.size());
  for (const std::uint32_t t : chosen) facets_.push_back(make_facet(mesh, t));
  nodes_.reserve(facets_.size());
  if (!facets_.empty()) split(0, static_cast<std::uint32_t>(facets_.size()));
}

DistanceTree::Facet DistanceTree::make_facet(const GridMesh& mesh, std::uint32_t triangle) {
  Facet f;
  f.triangle = triangle;
  for (int k = 0; k < 3; ++k) f.corner[static_cast<std::size_t>(k)] = mesh.corner(triangle, k);
  const Vec3 area = area_vector(f.corner[0], f.corner[1], f.corner[2]);
  f.normal = area.stableNormalized();
  for (std::size_t k = 0; k < 3; ++k) {
    f.edge[k] = f.corner[(k + 1) % 3] - f.corner[k];
    const double square = f.edge[k].squaredNorm();
    f.inverse_square[k] = square > 0.0 ? 1.0 / square : 0.0;
    f.outward[k] = f.edge[k].cross(f.normal);
  }
  return f;
}

void DistanceTree::split(std::uint32_t begin, std::uint32_t end) {
  Node node{facets_[begin].corner[0], facets_[begin].corner[0], begin, end - begin};
  for (std::uint32_t n = begin; n < end; ++n)
    for (const Vec3& corner : facets_[n].corner) {
      node.low = node.low.cwiseMin(corner);
      node.high = node.high.cwiseMax(corner);
    }
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (node.count <= kLeafFacets) return;
  Eigen::Index axis = 0;
  (node.high - node.low).maxCoeff(&axis);
  const auto place = [axis](const Facet& f) { return f.corner[0][axis] + f.corner[1][axis] + f.corner[2][axis]; };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(facets_.begin() + begin, facets_.begin() + middle, facets_.begin() + end,
                   [&](const Facet& a, const Facet& b) {
                     return place(a) != place(b) ? place(a) < place(b) : a.triangle < b.triangle;
                   });
  nodes_[index].count = 0;
  split(begin, middle);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  split(middle, end);
}

double DistanceTree::square_distance(const Facet& f, const Vec3& p) noexcept {
  double best = HUGE_VAL;
  bool beyond = f.normal.isZero(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 from = p - f.corner[k];
    if (!f.normal.isZero(0.0) && !(from.dot(f.outward[k]) > 0.0)) continue;
    beyond = true;
    const double t = std::clamp(from.dot(f.edge[k]) * f.inverse_square[k], 0.0, 1.0);
    best = std::min(best, (from - t * f.edge[k]).squaredNorm());
  }
  if (beyond) return best;
  const double height = f.normal.dot(p - f.corner[0]);
  return height * height;
}

double DistanceTree::square_distance(const Node& node, const Vec3& p) noexcept {
  return (node.low - p).cwiseMax(p - node.high).cwiseMax(0.0).squaredNorm();
}

double DistanceTree::nearest(const Vec3& p, double bound) const noexcept {
  std::uint32_t place = kNoPlace;
  return nearest(p, bound, place);
}

double DistanceTree::nearest(const Vec3& p, double bound, std::uint32_t& place) const noexcept {
  if (nodes_.empty()) return bound;
  struct Entry {
    std::uint32_t node;
    double square;
  };
  std::array<Entry, kDeepest> stack;
  std::size_t depth = 0;
  double best = bound * bound;
  const auto compare = [&](std::uint32_t facet) {
    const double square = square_distance(facets_[facet], p);
    if (square < best) best = square, place = facet;
  };
  if (place != kNoPlace) compare(place);
  stack[depth++] = {0, square_distance(nodes_[0], p)};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.square > best * (1.0 + kRoundingRelative) + kRoundingAbsolute) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t n = 0; n < node.count; ++n) compare(node.first + n);
    if (node.count != 0) continue;
    Entry near{entry.node + 1, square_distance(nodes_[entry.node + 1], p)};
    Entry far{node.first, square_distance(nodes_[node.first], p)};
    if (far.square < near.square) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return std::min(bound, std::sqrt(best));
}

bool DistanceTree::on_ray(const Node& node, const Vec3& origin, const Vec3& direction) noexcept {
  double enter = 0.0, leave = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < node.low[axis] || origin[axis] > node.high[axis]) return false;
      continue;
    }
    const double a = (node.low[axis] - origin[axis]) / direction[axis],
                 b = (node.high[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave + kRoundingAbsolute;
}

}  // namespace voxtouch::voxmap
