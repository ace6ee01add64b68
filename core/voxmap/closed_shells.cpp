#include "core/voxmap/closed_shells.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <span>
#include <tuple>

#include "core/voxmap/exact_sign.hpp"

namespace voxtouch::voxmap {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using KeyedTriangle = std::pair<Corners, std::uint32_t>;  // sorted corners, number

std::uint64_t mix(const Vec3& u) noexcept {
  std::uint64_t h = 0x9e3779b97f4a7c15ULL;
  for (int axis = 0; axis < 3; ++axis) {
    h ^= std::bit_cast<std::uint64_t>(u[axis]);
    h *= 0xbf58476d1ce4e5b9ULL;
    h ^= h >> 29;
  }
  return h;
}

Corners welded_corners(const GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                       std::uint32_t t) {
  const Corners& c = (*mesh.triangles)[t];
  return {welded[c[0]], welded[c[1]], welded[c[2]]};
}

/// Triangles grouped by their three corners, the first of a group first: sorted by (lowest, middle,
/// highest corner, triangle).
std::vector<KeyedTriangle> sorted_by_corners(const GridMesh& mesh,
                                             const std::vector<std::uint32_t>& welded,
                                             const std::vector<std::uint32_t>& triangles) {
  std::vector<KeyedTriangle> keyed(triangles.size());
  std::vector<std::uint32_t> start(welded.size() + 1, 0);
  const auto key = [&](std::uint32_t t) {
    Corners c = welded_corners(mesh, welded, t);
    std::sort(c.begin(), c.end());
    return c;
  };
  for (const std::uint32_t t : triangles)
    ++start[key(t)[0] + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (const std::uint32_t t : triangles) {
    const Corners c = key(t);
    keyed[fill[c[0]]++] = {c, t};
  }
  for (std::size_t v = 0; v + 1 < start.size(); ++v)
    if (start[v + 1] - start[v] > 1)
      std::sort(keyed.begin() + start[v], keyed.begin() + start[v + 1]);
  return keyed;
}

/// Union-find whose links store one bit: whether two triangles agree in orientation.
class Orientation {
 public:
  explicit Orientation(std::size_t count) : parent_(count), flipped_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t root(std::uint32_t t) {
    std::uint8_t flip = 0;
    std::uint32_t r = t;
    for (; parent_[r] != r; r = parent_[r])
      flip ^= flipped_[r];
    while (parent_[t] != r && t != r) {  // path compression keeps the bit relative to the root
      const std::uint32_t next = parent_[t];
      const std::uint8_t own = flipped_[t];
      parent_[t] = r, flipped_[t] = flip;
      flip ^= own;
      t = next;
    }
    return r;
  }
  bool flipped(std::uint32_t t) { return root(t) != t && flipped_[t]; }
  void join(std::uint32_t a, std::uint32_t b, bool opposite) {
    const std::uint32_t ra = root(a), rb = root(b);
    const bool flip = flipped(a) ^ flipped(b) ^ opposite;
    if (ra == rb)
      return;  // a contradiction (a Moebius band) appears later as an unbalanced edge
    const auto [low, high] = std::minmax(ra, rb);
    parent_[high] = low, flipped_[high] = flip;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> flipped_;
};

struct Edge {
  std::uint32_t far, slot;  ///< higher vertex; position in the list of triangles
  bool forward;             ///< traversed from the lower vertex to the higher
};

/// Visits every edge of the listed triangles, grouped by (lower, higher vertex); `visit(group)`
/// receives a span of `Edge`.
template <class Visit>
void for_each_edge(const GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                   const std::vector<std::uint32_t>& triangles, Visit&& visit) {
  std::vector<std::uint32_t> start(welded.size() + 1, 0);
  const auto edges_of = [&](std::size_t slot, auto&& f) {
    const Corners c = welded_corners(mesh, welded, triangles[slot]);
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = c[n], b = c[(n + 1) % 3];
      if (a != b)
        f(std::min(a, b), Edge{std::max(a, b), static_cast<std::uint32_t>(slot), a < b});
    }
  };
  for (std::size_t s = 0; s < triangles.size(); ++s)
    edges_of(s, [&](std::uint32_t near, const Edge&) { ++start[near + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Edge> edges(start.back());
  std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
  for (std::size_t s = 0; s < triangles.size(); ++s)
    edges_of(s, [&](std::uint32_t near, const Edge& edge) { edges[fill[near]++] = edge; });
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    const auto first = edges.begin() + start[v], last = edges.begin() + start[v + 1];
    std::sort(first, last, [](const Edge& a, const Edge& b) {
      return std::tie(a.far, a.slot) < std::tie(b.far, b.slot);
    });
    for (auto at = first; at != last;) {
      auto end = at;
      while (end != last && end->far == at->far)
        ++end;
      visit(std::span<const Edge>(at, end));
      at = end;
    }
  }
}

double twice_area(const GridMesh& mesh, std::uint32_t t) {
  return area_vector(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).stableNorm();
}

/// One attempt: finds the parts that the listed triangles form, sets the roles of closed parts and
/// returns the triangles of open ones.
std::vector<std::uint32_t> settle_parts(const GridMesh& mesh,
                                        const std::vector<std::uint32_t>& welded,
                                        const std::vector<std::uint32_t>& triangles,
                                        ClosedShells& shells, std::size_t& open_parts) {
  const std::size_t count = triangles.size();
  Orientation part(count), patch(count);
  std::vector<std::uint8_t> open(count, 0), unbalanced(count, 0);
  // every edge that may close is traversed equally often in both directions: no triangle must be
  // flipped
  bool tidy = true;
  for_each_edge(mesh, welded, triangles, [&](std::span<const Edge> group) {
    int balance = 0;
    for (const Edge& edge : group)
      balance += edge.forward ? 1 : -1;
    tidy = tidy && (balance == 0 || group.size() % 2 != 0);
    for (const Edge& edge : group.subspan(1))
      part.join(group[0].slot, edge.slot, false);
    if (group.size() == 2)
      patch.join(group[0].slot, group[1].slot, group[0].forward == group[1].forward);
    if (group.size() % 2 != 0)
      open[group[0].slot] = 1;
  });
  std::vector<double> kept_area(count, 0.0), flipped_area(count, 0.0);
  for (std::uint32_t s = 0; s < count; ++s) {
    if (open[s])
      open[part.root(s)] = 1;
    if (!tidy)
      (patch.flipped(s) ? flipped_area : kept_area)[patch.root(s)] +=
          twice_area(mesh, triangles[s]);
  }
  const auto flip = [&](std::uint32_t s) {
    const std::uint32_t root = patch.root(s);
    return patch.flipped(s) != (flipped_area[root] > kept_area[root]);
  };
  if (!tidy)
    for_each_edge(mesh, welded, triangles, [&](std::span<const Edge> group) {
      int balance = 0;
      for (const Edge& edge : group)
        balance += edge.forward != flip(edge.slot) ? 1 : -1;
      if (balance != 0)
        unbalanced[part.root(group[0].slot)] = 1;
    });
  std::vector<std::uint32_t> left;
  open_parts = 0;
  for (std::uint32_t s = 0; s < count; ++s) {
    const std::uint32_t root = part.root(s), t = triangles[s];
    if (open[root]) {
      open_parts += root == s;
      left.push_back(t);
      continue;
    }
    shells.closed_parts += root == s;
    shells.role[t] = unbalanced[root] ? ShellRole::kParity
                     : flip(s)        ? ShellRole::kFlipped
                                      : ShellRole::kKept;
    shells.patch[t] = triangles[patch.root(s)];
  }
  return left;
}

}  // namespace

std::vector<std::uint32_t> weld_vertices(const GridMesh& mesh) {
  const std::size_t slots = std::bit_ceil(2 * mesh.u.size() + 2);
  constexpr std::uint32_t kEmpty = 0xffffffffU;
  std::vector<std::uint32_t> table(slots, kEmpty), welded(mesh.u.size());
  for (std::uint32_t v = 0; v < mesh.u.size(); ++v) {
    std::size_t slot = mix(mesh.u[v]) & (slots - 1);
    while (table[slot] != kEmpty && mesh.u[table[slot]] != mesh.u[v])
      slot = (slot + 1) & (slots - 1);
    if (table[slot] == kEmpty)
      table[slot] = v;
    welded[v] = table[slot];
  }
  return welded;
}

std::vector<TriangleState> judge_triangles(const GridMesh& mesh,
                                           const std::vector<std::uint32_t>& welded) {
  std::vector<TriangleState> state(mesh.size(), TriangleState::kSound);
  std::vector<std::uint32_t> all(mesh.size());
  std::iota(all.begin(), all.end(), 0U);
  for (const std::uint32_t t : all)
    if (area_vector(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)).isZero(0.0))
      state[t] = TriangleState::kZeroArea;
  const auto keyed = sorted_by_corners(mesh, welded, all);
  for (std::size_t n = 1; n < keyed.size(); ++n)
    if (keyed[n].first == keyed[n - 1].first && state[keyed[n].second] == TriangleState::kSound)
      state[keyed[n].second] = TriangleState::kDuplicate;
  return state;
}

ClosedShells find_closed_shells(const GridMesh& mesh, const std::vector<std::uint32_t>& welded,
                                const std::vector<TriangleState>& state) {
  ClosedShells shells;
  shells.role.assign(mesh.size(), ShellRole::kNone);
  shells.patch.assign(mesh.size(), 0);
  std::vector<std::uint32_t> sound;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
    if (state[t] == TriangleState::kSound)
      sound.push_back(t);
  std::vector<std::uint32_t> left = settle_parts(mesh, welded, sound, shells, shells.open_parts);
  if (left.empty())
    return shells;

  // Open parts get two more attempts, each with the previously excluded triangles.
  const auto with = [&](TriangleState extra) {
    std::vector<std::uint8_t> touched(welded.size(), 0);
    for (const std::uint32_t t : left)
      for (const std::uint32_t v : welded_corners(mesh, welded, t))
        touched[v] = 1;
    std::vector<std::uint32_t> candidates = left;
    for (std::uint32_t t = 0; t < mesh.size(); ++t) {
      const Corners c = welded_corners(mesh, welded, t);
      if (state[t] == extra && c[0] != c[1] && c[1] != c[2] && c[2] != c[0] && touched[c[0]] &&
          touched[c[1]] && touched[c[2]])
        candidates.push_back(t);
    }
    std::sort(candidates.begin(), candidates.end());
    return candidates;
  };
  std::size_t still_open = 0;
  for (const TriangleState extra : {TriangleState::kDuplicate, TriangleState::kZeroArea}) {
    const std::vector<std::uint32_t> candidates = with(extra);
    if (candidates.size() == left.size())
      continue;
    std::vector<std::uint32_t> rest = settle_parts(mesh, welded, candidates, shells, still_open);
    if (rest.size() == candidates.size())
      continue;
    shells.open_parts = still_open;
    std::erase_if(rest, [&](std::uint32_t t) { return state[t] != TriangleState::kSound; });
    left = std::move(rest);
    if (left.empty())
      break;
  }
  shells.open = std::move(left);
  return shells;
}

ClosedShells find_closed_shells(const GridMesh& mesh) {
  const std::vector<std::uint32_t> welded = weld_vertices(mesh);
  return find_closed_shells(mesh, welded, judge_triangles(mesh, welded));
}

std::vector<std::uint32_t> triangles_of_closed_parts(const ClosedShells& shells) {
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t t = 0; t < shells.role.size(); ++t)
    if (shells.role[t] != ShellRole::kNone)
      chosen.push_back(t);
  return chosen;
}

}  // namespace voxtouch::voxmap
