#include "core/reference/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace voxtouch::reference {
namespace {

using Point = Eigen::Vector2d;

/// Twice the area of a triangle, positive if it is counter-clockwise.
double twice_area(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The remaining polygon.
class Outline {
 public:
  explicit Outline(std::span<const Vec3> corners) {
    const std::size_t n = corners.size();
    Vec3 normal = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < n; ++k) {
      normal += (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
    }
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (normal[axis] < 0)
      std::swap(u, v);
    doubled_area_ = std::abs(normal[axis]);
    for (std::uint32_t k = 0; k < n; ++k) {
      if (corners[k] == corners[(k + 1) % n])
        continue;
      numbers_.push_back(k);
      points_.emplace_back(corners[k][u], corners[k][v]);
    }
  }

  double doubled_area() const { return doubled_area_; }
  std::size_t size() const { return points_.size(); }
  double area_at(std::size_t k) const { return twice_area(at(k + size() - 1), at(k), at(k + 1)); }
  std::array<std::uint32_t, 3> triangle_at(std::size_t k) const {
    const std::size_t n = size();
    return {numbers_[(k + n - 1) % n], numbers_[k % n], numbers_[(k + 1) % n]};
  }
  void take_off(std::size_t k) {
    points_.erase(points_.begin() + static_cast<std::ptrdiff_t>(k));
    numbers_.erase(numbers_.begin() + static_cast<std::ptrdiff_t>(k));
  }

  /// The triangle at corner k has an area, no other corner lies in it or on its border, and its
  /// open side is inside the polygon.
  bool ear_at(std::size_t k) const {
    const std::size_t n = size();
    const Point &a = at(k + n - 1), &b = at(k), &c = at(k + 1);
    if (twice_area(a, b, c) <= 1e-13 * (b - a).norm() * (c - b).norm())
      return false;
    if (!inside_at(k + n - 1, c) || !inside_at(k + 1, a))
      return false;
    for (std::size_t j = 0; j < n; ++j) {
      const Point &p = at(j), &q = at(j + 1);
      const bool corner = p == a || p == b || p == c;
      if (!corner && twice_area(a, b, p) >= 0 && twice_area(b, c, p) >= 0 &&
          twice_area(c, a, p) >= 0)
        return false;
      const bool touches = p == a || p == c || q == a || q == c;
      if (!touches && twice_area(a, c, p) * twice_area(a, c, q) < 0 &&
          twice_area(p, q, a) * twice_area(p, q, c) < 0)
        return false;
    }
    return true;
  }

 private:
  const Point& at(std::size_t k) const { return points_[k % size()]; }

  /// Whether the segment from corner k to `end` starts inside the polygon (O'Rourke 1998, InCone).
  bool inside_at(std::size_t k, const Point& end) const {
    const Point &before = at(k + size() - 1), &own = at(k), &behind = at(k + 1);
    if (twice_area(own, behind, before) >= 0)
      return twice_area(own, end, before) >= 0 && twice_area(end, own, behind) >= 0;
    return !(twice_area(own, end, behind) > 0 && twice_area(end, own, before) > 0);
  }

  std::vector<Point> points_;
  std::vector<std::uint32_t> numbers_;
  double doubled_area_ = 0.0;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Vec3> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Outline left(corners);
  if (!(left.doubled_area() > 0))
    return triangles;
  double covered = 0.0;
  std::size_t from = 1;
  while (left.size() > 3) {
    const auto next = [&](auto suits) {
      std::size_t tried = 0;
      while (tried < left.size() && !suits((from + tried) % left.size()))
        ++tried;
      return tried;
    };
    std::size_t skipped = next([&](std::size_t k) { return left.ear_at(k); });
    // Without an ear: a path that runs forward and back along one line.
    if (skipped == left.size())
      skipped = next([&](std::size_t k) { return left.area_at(k) == 0; });
    if (skipped == left.size())
      throw std::runtime_error("a polygon intersects itself; export triangles");
    from = (from + skipped) % left.size();
    covered += left.area_at(from);
    triangles.push_back(left.triangle_at(from));
    left.take_off(from);
    from %= left.size();
  }
  if (left.size() == 3) {
    covered += std::abs(left.area_at(1));
    triangles.push_back(left.triangle_at(1));
  }
  if (std::abs(covered - left.doubled_area()) > 1e-6 * left.doubled_area())
    throw std::runtime_error("a polygon intersects itself; export triangles");
  return triangles;
}

}  // namespace voxtouch::reference
