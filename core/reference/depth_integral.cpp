#include "core/reference/depth_integral.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

namespace voxtouch::reference {
namespace {

/// Of the resolution: smaller differences of depth count as linear.
constexpr double kBendRatio = 0.02;
constexpr double kLongestRatio = 4.0;   ///< of the resolution: larger triangles are always split
constexpr double kShortestRatio = 0.5;  ///< of the resolution: smaller triangles are never split

/// A point of the tool in W and its depth; negative outside.
struct Sample {
  Vec3 x;
  double depth;
};

/// Hash of the bits of a position: the middle of an edge is bit-identical for both adjacent
/// triangles.
struct PlaceHash {
  std::size_t operator()(const Vec3& x) const noexcept {
    std::uint64_t hash = 0;
    for (const double v : {x.x(), x.y(), x.z()})
      hash = std::rotl(hash ^ std::bit_cast<std::uint64_t>(v + 0.0), 29) * 0x9e3779b97f4a7c15;
    return hash ^ hash >> 32;
  }
};

class DepthIntegral {
 public:
  DepthIntegral(const ToolTriangles& tool, const Pose& pose, double resolution,
                const DepthQuery& distance)
      : tool_(tool),
        pose_(pose),
        resolution_(resolution),
        distance_(distance) {}

  TrueWrench run() {
    for (std::size_t n = 0; n < tool_.nodes().size();) {
      const ToolTriangles::Node& node = tool_.nodes()[n];
      if (-depth(pose_ * node.centre) > node.radius) {
        n = node.skip;
        continue;
      }
      if (node.leaf)
        for (std::uint32_t t = node.first; t < node.last; ++t)
          add_triangle(tool_.triangle(t));
      n = node.leaf ? node.skip : n + 1;
    }
    return out_;
  }

 private:
  double depth(const Vec3& x) {
    ++out_.samples;
    return -distance_(x);
  }
  /// Depth of a position shared with neighbours.
  Sample shared(const Vec3& x) {
    const auto [known, is_new] = known_.try_emplace(x, 0.0);
    if (is_new)
      known->second = depth(x);
    return {x, known->second};
  }
  Sample between(const Sample& a, const Sample& b) { return shared(0.5 * (a.x + b.x)); }

  void add_triangle(const ToolTriangle& t) {
    const Vec3 area = 0.5 * (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
    if (area.isZero(0.0))
      return;
    const std::array<Vec3, 3> c{pose_ * t.corner[0], pose_ * t.corner[1], pose_ * t.corner[2]};
    const Vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
    const double at_middle = depth(middle);
    if (-at_middle > reach(c[0], c[1], c[2], middle))
      return;
    const std::array<Sample, 3> corner{shared(c[0]), shared(c[1]), shared(c[2])};
    add(corner[0], corner[1], corner[2], {middle, at_middle}, pose_.orientation * area);
  }

  static double reach(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& middle) {
    return std::sqrt(std::max(
        {(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
  }

  /// Whether the free balls around the corners cover the triangle: none of its points is farther
  /// from the nearest corner than the longest edge over sqrt(3).
  static bool covered(const Sample& a, const Sample& b, const Sample& c) {
    const double gap = -std::max({a.depth, b.depth, c.depth});
    const double square =
        std::max({(a.x - b.x).squaredNorm(), (b.x - c.x).squaredNorm(), (c.x - a.x).squaredNorm()});
    return gap > 0.0 && gap * gap * 3.0 > square;
  }

  void add_part(const Sample& a, const Sample& b, const Sample& c, const Vec3& area) {
    if (covered(a, b, c))
      return;
    const Vec3 middle = (a.x + b.x + c.x) / 3.0;
    add(a, b, c, {middle, depth(middle)}, area);
  }

  void add(const Sample& a, const Sample& b, const Sample& c, const Sample& middle,
           const Vec3& area) {
    const double radius = reach(a.x, b.x, c.x, middle.x);
    if (-middle.depth > radius)
      return;
    const Sample ab = between(a, b), bc = between(b, c), ca = between(c, a);
    const double bend = std::max({std::abs(ab.depth - 0.5 * (a.depth + b.depth)),
                                  std::abs(bc.depth - 0.5 * (b.depth + c.depth)),
                                  std::abs(ca.depth - 0.5 * (c.depth + a.depth)),
                                  std::abs(middle.depth - (a.depth + b.depth + c.depth) / 3.0)});
    const bool even = bend <= kBendRatio * resolution_ && radius <= kLongestRatio * resolution_;
    const Vec3 quarter = 0.25 * area;
    if (!even && radius > kShortestRatio * resolution_) {
      add_part(a, ab, ca, quarter), add_part(ab, b, bc, quarter), add_part(ca, bc, c, quarter);
      if (!covered(bc, ca, ab))
        add(bc, ca, ab, middle, quarter);  // its centre is that of the whole
      return;
    }
    if (std::min({a.depth, b.depth, c.depth, ab.depth, bc.depth, ca.depth}) >= 0.0) {
      add_quadrature(ab, bc, ca, area);
      return;
    }
    clip(a, ab, ca, quarter), clip(ab, b, bc, quarter), clip(ca, bc, c, quarter),
        clip(bc, ca, ab, quarter);
  }

  /// The part of a triangle that is inside, for linear depth.
  void clip(Sample a, Sample b, Sample c, const Vec3& area) {
    const int inside = (a.depth > 0.0) + (b.depth > 0.0) + (c.depth > 0.0);
    if (inside == 0)
      return;
    if (inside == 3)
      return add_linear(a, b, c, area);
    const bool odd_is_inside =
        inside == 1;  // one corner is on the other side than the two others: make it `a`
    while ((a.depth > 0.0) != odd_is_inside) {
      const Sample first = a;
      a = b, b = c, c = first;
    }
    const double to_b = a.depth / (a.depth - b.depth), to_c = a.depth / (a.depth - c.depth);
    const Sample on_ab{a.x + to_b * (b.x - a.x), 0.0}, on_ac{a.x + to_c * (c.x - a.x), 0.0};
    if (odd_is_inside)
      return add_linear(a, on_ab, on_ac, to_b * to_c * area);
    add_linear(on_ab, b, c, (1.0 - to_b) * area);
    add_linear(on_ab, c, on_ac, to_b * (1.0 - to_c) * area);
  }

  static Sample mean(const Sample& a, const Sample& b) {
    return {0.5 * (a.x + b.x), 0.5 * (a.depth + b.depth)};
  }
  void add_linear(const Sample& a, const Sample& b, const Sample& c, const Vec3& area) {
    add_quadrature(mean(a, b), mean(b, c), mean(c, a), area);
  }

  /// Quadrature at the midpoints of a triangle's edges: exact for quadratic functions, such as the
  /// torque of a linear depth.
  void add_quadrature(const Sample& ab, const Sample& bc, const Sample& ca, const Vec3& area) {
    const Vec3 inward_third = area / -3.0;
    for (const Sample* s : {&ab, &bc, &ca}) {
      const Vec3 force = s->depth * inward_third;
      out_.wrench.force += force;
      out_.wrench.torque += (s->x - pose_.position).cross(force);
      if (s->depth > out_.depth_m)
        out_.depth_m = s->depth, out_.deepest = s->x;
    }
    out_.area_m2 += area.norm();
  }

  const ToolTriangles& tool_;
  Pose pose_;
  double resolution_;
  const DepthQuery& distance_;
  std::unordered_map<Vec3, double, PlaceHash> known_;  ///< depths at corners and edge midpoints
  TrueWrench out_;
};

}  // namespace

TrueWrench integrate_depth(const ToolTriangles& tool, const Pose& pose_WT, double resolution_m,
                           const DepthQuery& distance) {
  return DepthIntegral(tool, pose_WT, resolution_m, distance).run();
}

}  // namespace voxtouch::reference
