#include "core/voxmap/solid_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/voxmap/distance_tree.hpp"
#include "core/voxmap/exact_sign.hpp"
#include "core/voxmap/winding.hpp"

namespace voxtouch::voxmap {
namespace {

/// Points this close are merged [voxels, for coordinates up to 1].
constexpr double kSameVoxels = 1e-9;

struct Box {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Vec3& p) noexcept { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  void add(const Box& other) noexcept { add(other.low), add(other.high); }
  bool meets(const Box& other) const noexcept {
    return (low.array() <= other.high.array() + kSeamVoxels).all() &&
           (other.low.array() <= high.array() + kSeamVoxels).all();
  }
};

Box box_of(const GridMesh& mesh, std::uint32_t t) noexcept {
  Box box;
  for (int k = 0; k < 3; ++k)
    box.add(mesh.corner(t, k));
  return box;
}

using Polygon = std::vector<Vec3>;  ///< convex
/// Intersection of another triangle with the plane of the triangle that is cut.
struct Cut {
  Vec3 from, to;
};

/// Triangles that may meet: of patches whose boxes meet, those whose own boxes meet.
class Neighbours {
 public:
  Neighbours(const GridMesh& mesh, const ClosedShells& shells) : mesh_(mesh), shells_(shells) {
    for (std::uint32_t t = 0; t < mesh.size(); ++t)
      if (shells.role[t] != ShellRole::kNone)
        patches_[shells.patch[t]].box.add(box_of(mesh, t));
    find_pairs();
    if (sheets_.empty() && shells.open.empty())
      return;
    for (std::uint32_t t = 0; t < mesh.size(); ++t)
      if (shells.role[t] != ShellRole::kNone)
        add(shells.patch[t], t);
    // Open triangles are cut and cut no others.
    for (const std::uint32_t t : shells.open)
      open_.push_back({box_of(mesh, t), t});
  }
  bool none() const noexcept { return sheets_.empty() && (open_.empty() || patches_.empty()); }

  /// Calls f(triangle, others) for each triangle that others may meet.
  template <class F>
  void for_each(F&& f) {
    for (auto& [name, others] : sheets_) {
      std::ranges::sort(others);
      for (const Entry& one : patches_.at(name).entries)
        visit(one, others, f);
    }
    std::vector<std::uint32_t> all;
    for (const auto& [name, patch] : patches_)
      all.push_back(name);
    for (const Entry& one : open_)
      visit(one, all, f);
  }

 private:
  struct Entry {
    Box box;
    std::uint32_t triangle = 0;
  };
  struct Patch {
    Box box;
    double widest = 0.0;         ///< largest extent of a triangle along x
    std::vector<Entry> entries;  ///< sorted by their start along x
    bool sorted = false;
  };
  void find_pairs() {
    std::vector<std::pair<std::uint32_t, const Patch*>> order;
    for (const auto& [name, patch] : patches_)
      order.push_back({name, &patch});
    std::ranges::sort(order, {}, [](const auto& p) { return p.second->box.low.x(); });
    for (std::size_t a = 0; a < order.size(); ++a)
      for (std::size_t b = a + 1; b < order.size() && begins_before(order[b], order[a]); ++b)
        if (order[a].second->box.meets(order[b].second->box)) {
          sheets_[order[a].first].push_back(order[b].first);
          sheets_[order[b].first].push_back(order[a].first);
        }
  }
  template <class P>
  static bool begins_before(const P& later, const P& first) noexcept {
    return later.second->box.low.x() <= first.second->box.high.x() + kSeamVoxels;
  }
  void add(std::uint32_t name, std::uint32_t t) {
    Patch& patch = patches_[name];
    const Entry entry{box_of(mesh_, t), t};
    patch.widest = std::max(patch.widest, entry.box.high.x() - entry.box.low.x());
    patch.entries.push_back(entry);
  }
  template <class F>
  void visit(const Entry& one, const std::vector<std::uint32_t>& names, F&& f) {
    found_.clear();
    bool within = false;
    for (const std::uint32_t name : names) {
      Patch& patch = patches_.at(name);
      if (!patch.box.meets(one.box))
        continue;
      within = true;
      gather(one, patch);
    }
    if (within)
      f(one.triangle, std::as_const(found_));
  }
  void gather(const Entry& one, Patch& patch) {
    const auto begin = [](const Entry& e) { return e.box.low.x(); };
    if (!std::exchange(patch.sorted, true))
      std::ranges::stable_sort(patch.entries, {}, begin);
    const double first = one.box.low.x() - patch.widest - kSeamVoxels;
    for (auto at = std::ranges::lower_bound(patch.entries, first, {}, begin);
         at != patch.entries.end() && at->box.low.x() <= one.box.high.x() + kSeamVoxels; ++at)
      if (at->box.meets(one.box))
        found_.push_back(at->triangle);
  }

  const GridMesh& mesh_;
  const ClosedShells& shells_;
  std::map<std::uint32_t, Patch> patches_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> sheets_;
  std::vector<Entry> open_;
  std::vector<std::uint32_t> found_;
};

/// A triangle and the pieces that others cut it into.
class CutTriangle {
 public:
  CutTriangle(const GridMesh& mesh, std::uint32_t t)
      : corners_{mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)},
        normal_(area_vector(corners_[0], corners_[1], corners_[2]).stableNormalized()) {
    double size = 1.0;
    for (const Vec3& c : corners_)
      size = std::max(size, c.lpNorm<Eigen::Infinity>());
    same_ = kSameVoxels * size;
  }
  const Vec3& normal() const noexcept { return normal_; }
  bool flat() const noexcept { return normal_.isZero(0.0); }

  void cut_by(const GridMesh& mesh, std::uint32_t other) {
    std::array<double, 3> height;
    std::vector<Vec3> on;
    for (int k = 0; k < 3; ++k)
      height[static_cast<std::size_t>(k)] = normal_.dot(mesh.corner(other, k) - corners_[0]);
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const double a = height[static_cast<std::size_t>(k)];
      const double b = height[static_cast<std::size_t>(next)];
      const Vec3 &from = mesh.corner(other, k), &to = mesh.corner(other, next);
      if (std::abs(a) <= kSeamVoxels)
        on.push_back(from - a * normal_);
      if ((a > kSeamVoxels && b < -kSeamVoxels) || (a < -kSeamVoxels && b > kSeamVoxels))
        on.push_back(from + a / (a - b) * (to - from));
    }
    if (on.size() == 3)  // coplanar: each of its sides is a cut
      for (std::size_t k = 0; k < 3; ++k)
        add({on[k], on[(k + 1) % 3]});
    if (on.size() == 2)
      add({on[0], on[1]});
  }

  /// The pieces, which together cover the triangle.
  std::vector<Polygon> pieces() const {
    struct Part {
      Polygon polygon;
      std::vector<Cut> cuts;
    };
    std::vector<Polygon> done;
    std::vector<Part> open{{{corners_.begin(), corners_.end()}, cuts_}};
    while (!open.empty()) {
      Part part = std::move(open.back());
      open.pop_back();
      while (!part.cuts.empty() && !reaches_into(part.polygon, part.cuts.back()))
        part.cuts.pop_back();
      if (part.cuts.empty()) {
        done.push_back(std::move(part.polygon));
        continue;
      }
      // Takes the middle of the list, so that an outline is halved.
      std::swap(part.cuts[part.cuts.size() / 2], part.cuts.back());
      if (!reaches_into(part.polygon, part.cuts.back())) {
        open.push_back(std::move(part));
        continue;
      }
      const Cut cut = part.cuts.back();
      part.cuts.pop_back();
      const Vec3 across = normal_.cross(cut.to - cut.from).stableNormalized();
      for (const double side : {1.0, -1.0}) {
        Part half{clipped(part.polygon, cut.from, side * across), {}};
        if (half.polygon.size() < 3)
          continue;
        for (const Cut& c : part.cuts)
          if (side * across.dot(c.from - cut.from) > same_ ||
              side * across.dot(c.to - cut.from) > same_)
            half.cuts.push_back(c);
        open.push_back(std::move(half));
      }
    }
    return done;
  }

 private:
  void add(const Cut& cut) {
    if ((cut.to - cut.from).norm() > same_)
      cuts_.push_back(cut);
  }
  /// Whether the cut passes through the interior of the piece.
  bool reaches_into(const Polygon& piece, const Cut& cut) const noexcept {
    double from = 0.0, to = 1.0;
    const Vec3 along = cut.to - cut.from;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const Vec3& a = piece[k];
      const Vec3 inward = normal_.cross(piece[(k + 1) % piece.size()] - a).stableNormalized();
      const double at_from = inward.dot(cut.from - a) - same_;
      const double slope = inward.dot(along);
      if (std::abs(slope) <= same_) {
        if (at_from <= 0.0)
          return false;
        continue;
      }
      const double at = -at_from / slope;
      (slope > 0.0 ? from : to) = slope > 0.0 ? std::max(from, at) : std::min(to, at);
    }
    return (to - from) * along.norm() > same_;
  }
  /// The part of `piece` on the side of `inward`.
  Polygon clipped(const Polygon& piece, const Vec3& at, const Vec3& inward) const {
    Polygon out;
    for (std::size_t k = 0; k < piece.size(); ++k) {
      const Vec3 &a = piece[k], &b = piece[(k + 1) % piece.size()];
      const double ha = inward.dot(a - at), hb = inward.dot(b - at);
      if (ha >= -same_)
        out.push_back(a);
      if ((ha > same_ && hb < -same_) || (ha < -same_ && hb > same_))
        out.push_back(a + ha / (ha - hb) * (b - a));
    }
    return out;
  }

  std::array<Vec3, 3> corners_;
  Vec3 normal_;
  double same_ = 0.0;
  std::vector<Cut> cuts_;
};

class Builder {
 public:
  Builder(const GridMesh& mesh, const ClosedShells& shells)
      : mesh_(mesh),
        shells_(shells),
        tree_(mesh, triangles_of_closed_parts(shells)),
        pieces_(mesh.size()) {}

  SolidSurface build(Neighbours& neighbours) {
    neighbours.for_each(
        [&](std::uint32_t t, const std::vector<std::uint32_t>& others) { judge(t, others); });
    return whole_ ? SolidSurface{} : gathered();
  }

 private:
  enum class Kept : std::uint8_t { kWhole, kPieces };

  void judge(std::uint32_t t, const std::vector<std::uint32_t>& others) {
    CutTriangle triangle(mesh_, t);
    if (triangle.flat())
      return;
    for (const std::uint32_t other : others)
      triangle.cut_by(mesh_, other);
    const std::vector<Polygon> all = triangle.pieces();
    std::vector<Polygon> kept;
    for (const Polygon& piece : all)
      if (is_surface(piece, triangle.normal()))
        kept.push_back(piece);
    if (kept.size() == all.size())
      return;
    whole_ = false;
    pieces_[t] = {Kept::kPieces, std::move(kept)};
  }

  bool is_surface(const Polygon& piece, const Vec3& normal) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& corner : piece)
      middle += corner;
    middle /= static_cast<double>(piece.size());
    const Vec3 step = kSeamVoxels * normal;
    return !(solid_at(middle + step) && solid_at(middle - step));
  }

  bool solid_at(const Vec3& at) {
    above_.clear();
    tree_.each_on_ray(at, Vec3::UnitZ(), [&](std::uint32_t t) { above_.push_back(t); });
    return inside_shells(mesh_, shells_, above_, at);
  }

  SolidSurface gathered() const {
    SolidSurface out;
    out.whole = false;
    out.mesh.vertices = mesh_.u;
    std::vector<bool> open(mesh_.size(), false);
    for (const std::uint32_t t : shells_.open)
      open[t] = true;
    for (std::uint32_t t = 0; t < mesh_.size(); ++t) {
      if (shells_.role[t] == ShellRole::kNone && !open[t])
        continue;  // another one has taken its place
      const std::size_t before = out.mesh.triangles.size();
      add(t, out.mesh);
      std::vector<std::uint32_t>& of = open[t] ? out.open : out.closed;
      for (std::size_t n = before; n < out.mesh.triangles.size(); ++n)
        of.push_back(static_cast<std::uint32_t>(n));
    }
    return out;
  }

  void add(std::uint32_t t, mesh::TriangleMesh& out) const {
    const auto& [kept, pieces] = pieces_[t];
    if (kept == Kept::kWhole)
      return out.triangles.push_back((*mesh_.triangles)[t]);
    for (const Polygon& piece : pieces) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), piece.begin(), piece.end());
      for (std::uint32_t k = 2; k < piece.size(); ++k)
        out.triangles.push_back({first, first + k - 1, first + k});
    }
  }

  const GridMesh& mesh_;
  const ClosedShells& shells_;
  DistanceTree tree_;
  std::vector<std::pair<Kept, std::vector<Polygon>>> pieces_;
  std::vector<std::uint32_t> above_;
  bool whole_ = true;
};

}  // namespace

SolidSurface solid_surface(const GridMesh& mesh, const ClosedShells& shells) {
  Neighbours neighbours(mesh, shells);
  if (neighbours.none())
    return {};
  return Builder(mesh, shells).build(neighbours);
}

mesh::TriangleMesh solid_surface(const mesh::TriangleMesh& mesh, const Grid& grid) {
  const GridMesh in_grid(mesh, grid);
  SolidSurface solid = solid_surface(in_grid, find_closed_shells(in_grid));
  if (solid.whole)
    return mesh;
  for (std::size_t v = 0; v < solid.mesh.vertices.size(); ++v) {
    Vec3& at = solid.mesh.vertices[v];
    at = v < mesh.vertices.size() ? mesh.vertices[v] : Vec3(grid.origin + grid.edge * at);
  }
  return std::move(solid.mesh);
}

}  // namespace voxtouch::voxmap
