#include "core/reference/signed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace voxtouch::reference {
namespace {

constexpr std::uint32_t kTrianglesOfSurfaceLeaf = 4;
constexpr std::size_t kDeepest = 64;  ///< halving 2^32 triangles takes fewer levels

double square_to_box(const Vec3& low, const Vec3& high, const Vec3& x) noexcept {
  return (low - x).cwiseMax(x - high).cwiseMax(0.0).squaredNorm();
}

double angle_at(const Vec3& tip, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 u = a - tip, v = b - tip;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Triangles by their directed edges. Empty if an edge is traversed twice in one direction or in
/// one direction only: not a two-manifold.
using EdgeOwners = std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>;

std::optional<EdgeOwners> manifold_edges(const ReferenceMesh& mesh) {
  EdgeOwners owner;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (!owner.emplace(std::pair(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), t).second)
        return std::nullopt;
  const bool paired = std::all_of(owner.begin(), owner.end(), [&](const auto& entry) {
    return owner.contains({entry.first.second, entry.first.first});
  });
  return paired ? std::optional(std::move(owner)) : std::nullopt;
}

/// Whether the triangles around every vertex form one fan: a walk from neighbour to neighbour
/// visits all of them.
bool one_fan_each(const ReferenceMesh& mesh, const EdgeOwners& owner) {
  std::vector<std::uint32_t> count(mesh.vertices.size(), 0), one(mesh.vertices.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      ++count[v], one[v] = t;
  for (std::uint32_t v = 0; v < count.size(); ++v) {
    if (count[v] == 0)
      continue;
    std::uint32_t t = one[v], walked = 0;
    do {
      const auto& corners = mesh.triangles[t];
      const auto k =
          static_cast<std::size_t>(std::find(corners.begin(), corners.end(), v) - corners.begin());
      t = owner.at({v, corners[(k + 2) % 3]});  // across the edge of this triangle towards v
    } while (++walked <= count[v] && t != one[v]);
    if (walked != count[v])
      return false;
  }
  return true;
}

/// Moeller and Trumbore 1997: whether the segment passes through the interior of the triangle.
bool passes_through(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& t) noexcept {
  const Vec3 ray = to - from, ab = t[1] - t[0], ac = t[2] - t[0], p = ray.cross(ac);
  const double det = ab.dot(p);
  if (det == 0.0)
    return false;
  const Vec3 s = (from - t[0]) / det, q = s.cross(ab);
  const double u = s.dot(p), v = ray.dot(q), along = ac.dot(q);
  return u > 0.0 && v > 0.0 && u + v < 1.0 && along > 0.0 && along < 1.0;
}

}  // namespace

SignedSurface::SignedSurface(const ReferenceMesh& mesh) : inside_(mesh) {
  if (!mesh.closed)
    throw std::invalid_argument("an open mesh has no interior and no signed distance");
  std::vector<Corners> all;
  double volume = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    all.push_back({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
    volume += (all[t][0] - all[0][0]).dot((all[t][1] - all[0][0]).cross(all[t][2] - all[0][0]));
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0U);
  build(order, 0, static_cast<std::uint32_t>(order.size()), all);
  for (const std::uint32_t t : order)
    triangles_.push_back(all[t]);

  const std::optional<EdgeOwners> owner = manifold_edges(mesh);
  if (!owner || !one_fan_each(mesh, *owner) || crosses_itself(mesh, order))
    return;
  const double side = volume < 0.0 ? -1.0 : 1.0;  // inverted
  std::vector<Vec3> face, corner(mesh.vertices.size(), Vec3::Zero());
  for (const Corners& t : all)
    face.push_back(side * (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized());
  for (std::size_t t = 0; t < all.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      corner[mesh.triangles[t][k]] +=
          angle_at(all[t][k], all[t][(k + 1) % 3], all[t][(k + 2) % 3]) * face[t];
  for (const std::uint32_t t : order) {
    const auto& ids = mesh.triangles[t];
    const auto over_edge = [&](std::size_t k) {
      return Vec3(face[t] + face[owner->at({ids[(k + 1) % 3], ids[k]})]);
    };
    normals_.push_back({face[t], over_edge(0), over_edge(1), over_edge(2), corner[ids[0]],
                        corner[ids[1]], corner[ids[2]]});
  }
  by_feature_ = true;
  by_feature_ = agrees_with_winding();
  if (!by_feature_)
    normals_.clear();
}

void SignedSurface::build(std::vector<std::uint32_t>& order, std::uint32_t first,
                          std::uint32_t last, const std::vector<Corners>& all) {
  const std::size_t here = nodes_.size();
  nodes_.emplace_back();
  Node node{all[order[first]][0], all[order[first]][0], first, last - first};
  for (std::uint32_t n = first; n < last; ++n)
    for (const Vec3& c : all[order[n]])
      node.low = node.low.cwiseMin(c), node.high = node.high.cwiseMax(c);
  if (last - first > kTrianglesOfSurfaceLeaf) {
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const auto key = [&](std::uint32_t t) {
      return all[t][0][axis] + all[t][1][axis] + all[t][2][axis];
    };
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(key(a), a) < std::pair(key(b), b);
                     });
    build(order, first, middle, all);
    node.first = static_cast<std::uint32_t>(nodes_.size()), node.count = 0;
    build(order, middle, last, all);
  }
  nodes_[here] = node;
}

/// Ericson, Real-Time Collision Detection (2005), 5.1.5.
SignedSurface::Nearest SignedSurface::on_triangle(const Corners& t, const Vec3& x) noexcept {
  const auto at = [&](const Vec3& point, std::uint32_t feature) {
    return Nearest{(x - point).squaredNorm(), point, kNoHint, feature};
  };
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ax = x - t[0];
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0)
    return at(t[0], 4);
  const Vec3 bx = x - t[1];
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3)
    return at(t[1], 5);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
    return at(t[0] + d1 / (d1 - d3) * ab, 1);
  const Vec3 cx = x - t[2];
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6)
    return at(t[2], 6);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
    return at(t[0] + d2 / (d2 - d6) * ac, 3);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return at(t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]), 2);
  const double all = va + vb + vc;
  return at(t[0] + vb / all * ab + vc / all * ac, 0);
}

SignedSurface::Nearest SignedSurface::nearest(const Vec3& x, std::uint32_t hint) const noexcept {
  Nearest best;
  best.square = std::numeric_limits<double>::infinity();
  const auto look_at = [&](std::uint32_t t) {
    Nearest found = on_triangle(triangles_[t], x);
    if (!(found.square < best.square || (found.square == best.square && t < best.triangle)))
      return;  // of equal ones the first, for any hint
    best = found, best.triangle = t;
  };
  if (hint < triangles_.size())
    look_at(hint);
  struct Waiting {
    std::uint32_t node;
    double square;
  };
  std::array<Waiting, kDeepest> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, square_to_box(nodes_[0].low, nodes_[0].high, x)};
  while (depth > 0) {
    const Waiting next = stack[--depth];
    if (next.square > best.square)
      continue;
    const Node& node = nodes_[next.node];
    if (node.count > 0) {
      for (std::uint32_t t = node.first; t < node.first + node.count; ++t)
        look_at(t);
      continue;
    }
    Waiting left{next.node + 1, 0.0}, right{node.first, 0.0};
    left.square = square_to_box(nodes_[left.node].low, nodes_[left.node].high, x);
    right.square = square_to_box(nodes_[right.node].low, nodes_[right.node].high, x);
    if (left.square < right.square)
      std::swap(left, right);
    stack[depth++] = left, stack[depth++] = right;  // the nearer one first
  }
  return best;
}

double SignedSurface::distance(const Vec3& x, std::uint32_t& hint) const noexcept {
  const Nearest found = nearest(x, hint);
  if (found.triangle == kNoHint)
    return std::numeric_limits<double>::quiet_NaN();  // `x` is not finite
  hint = found.triangle;
  const bool inside = by_feature_
                          ? (x - found.point).dot(normals_[found.triangle][found.feature]) < 0.0
                          : inside_.inside(x);
  return (inside ? -1.0 : 1.0) * std::sqrt(found.square);
}

bool SignedSurface::crosses_itself(const ReferenceMesh& mesh,
                                   const std::vector<std::uint32_t>& order) const {
  std::array<std::uint32_t, kDeepest> stack;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      if (from > to)
        continue;  // its neighbour has it in the other direction
      const Vec3 &a = mesh.vertices[from], &b = mesh.vertices[to], low = a.cwiseMin(b),
                 high = a.cwiseMax(b);
      std::size_t depth = 0;
      stack[depth++] = 0;
      while (depth > 0) {
        const std::uint32_t here = stack[--depth];
        const Node& node = nodes_[here];
        if ((node.low.array() > high.array()).any() || (node.high.array() < low.array()).any())
          continue;
        if (node.count == 0) {
          stack[depth++] = here + 1, stack[depth++] = node.first;
          continue;
        }
        for (std::uint32_t n = node.first; n < node.first + node.count; ++n) {
          const auto& ids = mesh.triangles[order[n]];
          const bool foreign = std::none_of(ids.begin(), ids.end(),
                                            [&](std::uint32_t v) { return v == from || v == to; });
          if (foreign && passes_through(a, b, triangles_[n]))
            return true;
        }
      }
    }
  return false;
}

bool SignedSurface::agrees_with_winding() const {
  const std::size_t stride = triangles_.size() / kTestedFaces + 1;
  for (std::size_t n = 0; n < triangles_.size(); n += stride) {
    const Corners& t = triangles_[n];
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    const double size = std::sqrt(std::max(
        {(t[1] - t[0]).squaredNorm(), (t[2] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm()}));
    const Vec3 step = (1e-6 * size + 1e-12 * middle.cwiseAbs().maxCoeff()) * normals_[n][0];
    for (const double ray : {1.0, -1.0}) {
      const Vec3 x = middle + ray * step;
      std::uint32_t hint = kNoHint;
      if ((distance(x, hint) < 0.0) != inside_.inside(x))
        return false;
    }
  }
  return true;
}

}  // namespace voxtouch::reference
