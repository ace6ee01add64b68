#include "core/voxmap/distance_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/types/clones.hpp"
#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

/// A box is skipped only if it is farther than the best distance by more than the rounding error.
/// The result is therefore the smallest of all computed distances, for any order of the boxes.
constexpr double kRoundingRelative = 1e-6, kRoundingAbsolute = 1e-9;

/// In the order of Eigen's sum of three products.
VOXTOUCH_INLINE double dot(double ax, double ay, double az, double bx, double by,
                           double bz) noexcept {
  return (ax * bx + ay * by) + az * bz;
}

/// The rows of a facet, each of three vectors of three numbers, for many points. `least`: a point
/// is beyond an edge if it is farther out. For most triangles all points are within most edges,
/// which are then skipped.
VOXTOUCH_CLONES void squares_to(const double* corner, const double* edge, const double* outward,
                                const double* inverse_square, const double* normal, double least,
                                const double* px, const double* py, const double* pz,
                                double* out) noexcept {
  constexpr std::size_t kCount = DistanceTree::Points::kCount;
  double out_by[kCount], best[kCount];
  for (std::size_t n = 0; n < kCount; ++n)
    best[n] = HUGE_VAL;
  for (int k = 0; k < 9; k += 3) {
    std::int64_t beyond = 0;
    for (std::size_t n = 0; n < kCount; ++n) {
      out_by[n] = dot(px[n] - corner[k], py[n] - corner[k + 1], pz[n] - corner[k + 2], outward[k],
                      outward[k + 1], outward[k + 2]);
      beyond |= out_by[n] > least ? 1 : 0;
    }
    if (beyond == 0)
      continue;
    for (std::size_t n = 0; n < kCount; ++n) {
      const double x = px[n] - corner[k], y = py[n] - corner[k + 1], z = pz[n] - corner[k + 2];
      double t = dot(x, y, z, edge[k], edge[k + 1], edge[k + 2]) * inverse_square[k / 3];
      t = t < 0.0 ? 0.0 : t;
      t = 1.0 < t ? 1.0 : t;
      const double rx = x - t * edge[k], ry = y - t * edge[k + 1], rz = z - t * edge[k + 2];
      const double square = dot(rx, ry, rz, rx, ry, rz);
      const double counts = out_by[n] > least ? square : HUGE_VAL;
      best[n] = counts < best[n] ? counts : best[n];
    }
  }
  for (std::size_t n = 0; n < kCount; ++n) {
    const double height = dot(normal[0], normal[1], normal[2], px[n] - corner[0], py[n] - corner[1],
                              pz[n] - corner[2]);
    out[n] = best[n] < HUGE_VAL ? best[n] : height * height;
  }
}

}  // namespace

DistanceTree::DistanceTree(const GridMesh& mesh, const std::vector<std::uint32_t>& chosen) {
  if (chosen.empty())
    return;
  std::vector<Place> places;
  places.reserve(chosen.size());
  for (const std::uint32_t t : chosen)
    places.push_back({mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2), t});
  nodes_.reserve(chosen.size());
  split(places, 0, static_cast<std::uint32_t>(places.size()));
  facets_.reserve(chosen.size());
  for (const Place& place : places)
    facets_.push_back(make_facet(mesh, place.triangle));
  for (std::size_t n = nodes_.size(); n-- > 0;)
    enclose(n);  // children follow their parents
}

DistanceTree::Facet DistanceTree::make_facet(const GridMesh& mesh, std::uint32_t triangle) {
  Facet f;
  f.triangle = triangle;
  for (int k = 0; k < 3; ++k)
    f.corner[static_cast<std::size_t>(k)] = mesh.corner(triangle, k);
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

void DistanceTree::split(std::vector<Place>& places, std::uint32_t begin, std::uint32_t end) {
  const std::size_t index = nodes_.size();
  nodes_.push_back({Vec3::Zero(), Vec3::Zero(), begin, end - begin});
  if (end - begin <= kLeafFacets)
    return;
  Eigen::AlignedBox3d box;
  for (std::uint32_t n = begin; n < end; ++n)
    box.extend(places[n].three_middles);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(places.begin() + begin, places.begin() + middle, places.begin() + end,
                   [axis](const Place& a, const Place& b) {
                     const double at_a = a.three_middles[axis], at_b = b.three_middles[axis];
                     return at_a != at_b ? at_a < at_b : a.triangle < b.triangle;
                   });
  nodes_[index].count = 0;
  split(places, begin, middle);
  nodes_[index].first = static_cast<std::uint32_t>(nodes_.size());
  split(places, middle, end);
}

void DistanceTree::enclose(std::size_t index) noexcept {
  Node& node = nodes_[index];
  if (node.count == 0) {
    node.low = nodes_[index + 1].low.cwiseMin(nodes_[node.first].low);
    node.high = nodes_[index + 1].high.cwiseMax(nodes_[node.first].high);
    return;
  }
  node.low = node.high = facets_[node.first].corner[0];
  for (std::uint32_t n = 0; n < node.count; ++n)
    for (const Vec3& corner : facets_[node.first + n].corner) {
      node.low = node.low.cwiseMin(corner);
      node.high = node.high.cwiseMax(corner);
    }
}

template <class F>
bool DistanceTree::each_edge_before(const Facet& f, const Vec3& p, F&& call) noexcept {
  const bool no_area = f.normal.isZero(0.0);
  bool beyond = no_area;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 from = p - f.corner[k];
    if (!no_area && !(from.dot(f.outward[k]) > 0.0))
      continue;
    beyond = true;
    const double t = std::clamp(from.dot(f.edge[k]) * f.inverse_square[k], 0.0, 1.0);
    call(Vec3(from - t * f.edge[k]));
  }
  return beyond;
}

double DistanceTree::square_distance(const Facet& f, const Vec3& p) noexcept {
  double best = HUGE_VAL;
  if (each_edge_before(
          f, p, [&](const Vec3& distance) { best = std::min(best, distance.squaredNorm()); }))
    return best;
  const double height = f.normal.dot(p - f.corner[0]);
  return height * height;
}

Vec3 DistanceTree::displacement(std::uint32_t place, const Vec3& p) const noexcept {
  const Facet& f = facets_[place];
  Vec3 least = Vec3::Zero();
  double best = HUGE_VAL;
  const auto keep = [&](const Vec3& distance) {
    if (const double square = distance.squaredNorm(); square < best)
      best = square, least = distance;
  };
  return each_edge_before(f, p, keep) ? least : Vec3(f.normal.dot(p - f.corner[0]) * f.normal);
}

double DistanceTree::square_distance(const Node& node, const Vec3& p) noexcept {
  return (node.low - p).cwiseMax(p - node.high).cwiseMax(0.0).squaredNorm();
}

double DistanceTree::nearest(const Vec3& p, double bound, std::uint32_t& place) const noexcept {
  if (nodes_.empty())
    return bound;
  struct Entry {
    std::uint32_t node;
    double square;
  };
  std::array<Entry, kDeepest> stack;
  std::size_t depth = 0;
  double best = bound * bound;
  const auto compare = [&](std::uint32_t facet) {
    const double square = square_distance(facets_[facet], p);
    if (square < best)
      best = square, place = facet;
  };
  if (place != kNoPlace)
    compare(place);
  stack[depth++] = {0, square_distance(nodes_[0], p)};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.square > best * (1.0 + kRoundingRelative) + kRoundingAbsolute)
      continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t n = 0; n < node.count; ++n)
      compare(node.first + n);
    if (node.count != 0)
      continue;
    Entry near{entry.node + 1, square_distance(nodes_[entry.node + 1], p)};
    Entry far{node.first, square_distance(nodes_[node.first], p)};
    if (far.square < near.square)
      std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return std::min(bound, std::sqrt(best));
}

void DistanceTree::squares(std::uint32_t place, const Points& points, Squares& out) const noexcept {
  static_assert(sizeof(std::array<Vec3, 3>) == 9 * sizeof(double));
  const Facet& f = facets_[place];
  squares_to(f.corner[0].data(), f.edge[0].data(), f.outward[0].data(), f.inverse_square.data(),
             f.normal.data(), f.normal.isZero(0.0) ? -HUGE_VAL : 0.0, points.x.data(),
             points.y.data(), points.z.data(), out.data());
}

bool DistanceTree::within(const Vec3& centre, double reach, std::size_t most,
                          std::vector<std::uint32_t>& places) const {
  places.clear();
  const double square = reach * reach * (1.0 + kRoundingRelative) + kRoundingAbsolute;
  return each_leaf([&](const Node& node) { return square_distance(node, centre) <= square; },
                   [&](const Node& leaf) {
                     if (places.size() + leaf.count > most)
                       return false;
                     for (std::uint32_t n = 0; n < leaf.count; ++n)
                       places.push_back(leaf.first + n);
                     return true;
                   });
}

bool DistanceTree::on_ray(const Node& node, const Vec3& origin, const Vec3& direction) noexcept {
  double enter = 0.0, leave = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < node.low[axis] || origin[axis] > node.high[axis])
        return false;
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
