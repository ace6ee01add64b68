#include "core/exact/simplified.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/exact/closest.hpp"
#include "core/exact/feature_mesh.hpp"

namespace voxtouch::exact {
namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Least height over longest side of a new face, unless a face around was thinner before.
constexpr double kLeastHeightRatio = 0.01;
constexpr int kMaxPasses = 40;

struct Triangle {
  Vec3 a, b, c;

  Vec3 area2() const { return (b - a).cross(c - a); }
  double height_ratio() const {
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return longest2 > 0.0 ? area2().norm() / longest2 : 0.0;
  }
  double distance(const Vec3& p) const {
    return (p - nearest_on_triangle(p, a, b, c).point).norm();
  }
};

/// A point of the given surface.
struct Sample {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< of its face; zero at a vertex
};

class Simplifier {
 public:
  Simplifier(const mesh::TriangleMesh& mesh, std::span<const std::uint32_t> owners,
             const SimplifyBounds& bounds)
      : points_(mesh.vertices),
        faces_(mesh.triangles),
        owners_(owners),
        bounds_(bounds),
        least_cosine_(std::cos(bounds.normal_rotation_rad)),
        removed_(faces_.size(), false),
        samples_of_(faces_.size()),
        faces_of_(points_.size()),
        kept_(points_.size(), false) {
    for (std::uint32_t f = 0; f < faces_.size(); ++f)
      add_face(f);
  }

  /// Looks at each vertex once. \returns whether one went.
  bool pass() {
    bool any = false;
    for (std::uint32_t v = 0; v < points_.size(); ++v) {
      if (kept_[v])
        continue;
      kept_[v] = !find_ring(v) || !collapse_nearest(v);
      any |= !kept_[v];
    }
    return any;
  }

  SimplifiedMesh result() const {
    SimplifiedMesh out;
    std::vector<std::uint32_t> number(points_.size(), kNone);
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      if (removed_[f])
        continue;
      Corners corners = faces_[f];
      for (std::uint32_t& v : corners) {
        if (number[v] == kNone) {
          number[v] = static_cast<std::uint32_t>(out.mesh.vertices.size());
          out.mesh.vertices.push_back(points_[v]);
        }
        v = number[v];
      }
      out.mesh.triangles.push_back(corners);
      out.triangles.push_back(f);
    }
    return out;
  }

 private:
  Triangle triangle(const Corners& c) const {
    return {points_[c[0]], points_[c[1]], points_[c[2]]};
  }
  std::uint32_t owner(std::uint32_t face) const { return owners_.empty() ? 0 : owners_[face]; }

  void add_face(std::uint32_t f) {
    const Vec3 normal = triangle(faces_[f]).area2().normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = faces_[f][k], b = faces_[f][(k + 1) % 3];
      faces_of_[a].push_back(f);
      samples_of_[f].push_back({0.5 * (points_[a] + points_[b]), normal});
    }
  }

  /// The corner of `face` that follows `v`.
  std::uint32_t after(std::uint32_t face, std::uint32_t v) const {
    const Corners& c = faces_[face];
    return c[0] == v ? c[1] : c[1] == v ? c[2] : c[0];
  }

  /// The neighbours of `v` in order, in `ring_`; false unless its faces are one closed fan of one
  /// owner.
  bool find_ring(std::uint32_t v) {
    const std::vector<std::uint32_t>& fan = faces_of_[v];
    ring_.clear();
    thinnest_ = 1.0;
    if (fan.size() < 3)
      return false;
    for (const std::uint32_t f : fan) {
      if (owner(f) != owner(fan.front()))
        return false;
      thinnest_ = std::min(thinnest_, triangle(faces_[f]).height_ratio());
    }
    std::uint32_t at = after(fan.front(), v);
    for (std::size_t k = 0; k < fan.size(); ++k) {
      ring_.push_back(at);
      const auto begins = [&](std::uint32_t f) { return after(f, v) == at; };
      const auto face = std::find_if(fan.begin(), fan.end(), begins);
      if (std::count_if(fan.begin(), fan.end(), begins) != 1)
        return false;
      at = after(*face, at);
      if ((at == ring_.front()) != (k + 1 == fan.size()))
        return false;
    }
    return true;
  }

  /// Collapses `v` onto the neighbour that changes the surface least.
  bool collapse_nearest(std::uint32_t v) {
    candidates_.clear();
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      if (!keeps_topology(v, ring_[k]))
        continue;
      if (const std::optional<double> off = distance_after(v, k))
        candidates_.emplace_back(*off, k);
    }
    std::sort(candidates_.begin(), candidates_.end());
    samples_.assign(1, {points_[v], Vec3::Zero()});
    for (const std::uint32_t f : faces_of_[v])
      samples_.insert(samples_.end(), samples_of_[f].begin(), samples_of_[f].end());
    for (const auto& [off, to] : candidates_) {
      if (!keeps_samples(to))
        continue;
      collapse(v, ring_[to]);
      return true;
    }
    return false;
  }

  /// Whether no faces would coincide: two vertices are next to both ends, and the faces are not all
  /// of a tetrahedron.
  bool keeps_topology(std::uint32_t v, std::uint32_t to) {
    common_.clear();
    if (ring_.size() == 3 && faces_of_[to].size() == 3)
      return false;
    for (const std::uint32_t f : faces_of_[to])
      for (const std::uint32_t w : faces_[f])
        if (w != to && w != v && std::find(ring_.begin(), ring_.end(), w) != ring_.end() &&
            std::find(common_.begin(), common_.end(), w) == common_.end())
          common_.push_back(w);
    return common_.size() == 2;
  }

  /// The new face `k` of ring_.size() - 2 after a collapse onto ring_[to].
  Triangle new_face(std::size_t to, std::size_t k) const {
    const std::size_t n = ring_.size();
    return {points_[ring_[to]], points_[ring_[(to + k + 1) % n]], points_[ring_[(to + k + 2) % n]]};
  }

  /// Distance of `v` from what a collapse onto ring_[to] leaves; none where that is out of bounds,
  /// or a face would turn over or be too thin.
  std::optional<double> distance_after(std::uint32_t v, std::size_t to) const {
    const double least_ratio = std::min(kLeastHeightRatio, thinnest_);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 2 < ring_.size(); ++k) {
      const Triangle face = new_face(to, k), before{points_[v], face.b, face.c};
      if (!(face.area2().dot(before.area2()) > 0.0) || face.height_ratio() < least_ratio)
        return std::nullopt;
      least = std::min(least, face.distance(points_[v]));
    }
    return least <= bounds_.distance_m ? std::optional(least) : std::nullopt;
  }

  bool keeps(const Triangle& face, const Vec3& unit, const Sample& sample) const {
    return (sample.normal.isZero() || unit.dot(sample.normal) >= least_cosine_) &&
           face.distance(sample.point) <= bounds_.distance_m;
  }

  bool keeps_samples(std::size_t to) {
    new_faces_.clear();
    for (std::size_t k = 0; k + 2 < ring_.size(); ++k) {
      const Triangle face = new_face(to, k);
      new_faces_.emplace_back(face, face.area2().normalized());
    }
    return std::all_of(samples_.begin(), samples_.end(), [&](const Sample& sample) {
      return std::any_of(new_faces_.begin(), new_faces_.end(),
                         [&](const auto& face) { return keeps(face.first, face.second, sample); });
    });
  }

  void collapse(std::uint32_t v, std::uint32_t to) {
    left_.clear();
    for (const std::uint32_t f : faces_of_[v]) {
      Corners& corners = faces_[f];
      samples_of_[f].clear();
      if (std::find(corners.begin(), corners.end(), to) == corners.end()) {
        std::replace(corners.begin(), corners.end(), v, to);
        faces_of_[to].push_back(f);
        left_.push_back(f);
        continue;
      }
      removed_[f] = true;
      for (const std::uint32_t w : corners)
        if (w != v)
          std::erase(faces_of_[w], f);
    }
    faces_of_[v].clear();
    for (const Sample& sample : samples_)
      samples_of_[holder_of(sample)].push_back(sample);
    for (const std::uint32_t w : ring_)
      kept_[w] = false;
  }

  /// The new face that keeps a sample.
  std::uint32_t holder_of(const Sample& sample) const {
    const auto found = std::find_if(left_.begin(), left_.end(), [&](std::uint32_t f) {
      const Triangle face = triangle(faces_[f]);
      return keeps(face, face.area2().normalized(), sample);
    });
    return found == left_.end() ? left_.front() : *found;
  }

  const std::vector<Vec3>& points_;
  std::vector<Corners> faces_;
  std::span<const std::uint32_t> owners_;
  SimplifyBounds bounds_;
  double least_cosine_;
  std::vector<bool> removed_;
  std::vector<std::vector<Sample>> samples_of_;       ///< of each face
  std::vector<std::vector<std::uint32_t>> faces_of_;  ///< of each vertex
  std::vector<bool> kept_;  ///< vertices that cannot go while their ring is as it is
  // Of the vertex that is looked at:
  std::vector<std::uint32_t> ring_, common_, left_;
  std::vector<std::pair<double, std::size_t>> candidates_;
  std::vector<Sample> samples_;
  std::vector<std::pair<Triangle, Vec3>> new_faces_;
  double thinnest_ = 0.0;
};

}  // namespace

SimplifiedMesh simplify(const mesh::TriangleMesh& welded, std::span<const std::uint32_t> owners,
                        const SimplifyBounds& bounds) {
  Simplifier simplifier(welded, owners, bounds);
  for (int pass = 0; pass < kMaxPasses && simplifier.pass(); ++pass) {
  }
  return simplifier.result();
}

}  // namespace voxtouch::exact
