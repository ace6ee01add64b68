#include "core/exact/crossing.hpp"

#include <algorithm>
#include <cmath>

#include "core/exact/closest.hpp"
#include "core/exact/limits.hpp"

namespace voxtouch::exact {
namespace {

/// c0 + c1 t + c2 t^2 + c3 t^3.
struct Cubic {
  double c0 = 0.0, c1 = 0.0, c2 = 0.0, c3 = 0.0;
  double at(double t) const noexcept { return ((c3 * t + c2) * t + c1) * t + c0; }

  /// No root in [0, 1], from the signs of its Bernstein coefficients; false where they do not
  /// decide.
  bool surely_no_root() const noexcept {
    const double b1 = c0 + c1 / 3.0, b2 = c0 + (2.0 * c1 + c2) / 3.0, b3 = c0 + c1 + c2 + c3;
    const bool above = c0 > 0.0 && b1 > 0.0 && b2 > 0.0 && b3 > 0.0;
    return above || (c0 < 0.0 && b1 < 0.0 && b2 < 0.0 && b3 < 0.0);
  }
};

/// det(u, v, w) of three vectors that move linearly.
Cubic volume(const MovingPoint& u, const MovingPoint& v, const MovingPoint& w) noexcept {
  const Vec3 du = u.to - u.from, dv = v.to - v.from, dw = w.to - w.from;
  const Vec3 n0 = u.from.cross(v.from);
  const Vec3 n1 = du.cross(v.from) + u.from.cross(dv);
  const Vec3 n2 = du.cross(dv);
  return {n0.dot(w.from), n1.dot(w.from) + n0.dot(dw), n2.dot(w.from) + n1.dot(dw), n2.dot(dw)};
}

MovingPoint less(const MovingPoint& a, const MovingPoint& b) noexcept {
  return {a.from - b.from, a.to - b.to};
}

/// The root between two times at which the signs differ.
double bisected(const Cubic& f, double low, double high) noexcept {
  const bool rises = f.at(low) < 0.0;
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (!(middle > low && middle < high))
      return middle;
    ((f.at(middle) < 0.0) == rises ? low : high) = middle;
  }
}

/// Calls `touches(t)` at each root in [0, 1], and at the extrema, where a double root may be; true
/// once it is.
template <class Touches>
bool touches_at_root(const Cubic& f, const Touches& touches) noexcept {
  if (f.surely_no_root())
    return false;
  std::array<double, 4> times{0.0, 1.0, 1.0, 1.0};
  std::size_t count = 1;
  const double a = 3.0 * f.c3, b = f.c2, c = f.c1;  // a t^2 + 2 b t + c, the derivative
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double q = -(b + std::copysign(root, b));
  double first = a != 0.0 ? q / a : 2.0, second = q != 0.0 ? c / q : 2.0;
  if (first > second)
    std::swap(first, second);
  if (first > 0.0 && first < 1.0)
    times[count++] = first;
  if (second > 0.0 && second < 1.0)
    times[count++] = second;
  times[count++] = 1.0;
  for (std::size_t k = 0; k < count; ++k) {
    if (touches(times[k]))
      return true;
    if (k == 0)
      continue;
    const double low = f.at(times[k - 1]), high = f.at(times[k]);
    if ((low < 0.0) == (high < 0.0))
      continue;
    if (touches(bisected(f, times[k - 1], times[k])))
      return true;
  }
  return false;
}

}  // namespace

bool vertex_passes_face(const MovingPoint& vertex,
                        const std::array<MovingPoint, 3>& face) noexcept {
  const Cubic f = volume(less(face[1], face[0]), less(face[2], face[0]), less(vertex, face[0]));
  return touches_at_root(f, [&](double t) {
    const Vec3 p = vertex.at(t);
    const Vec3 on = nearest_on_triangle(p, face[0].at(t), face[1].at(t), face[2].at(t)).point;
    return (p - on).squaredNorm() <= limits::kTouchM * limits::kTouchM;
  });
}

bool edges_pass(const std::array<MovingPoint, 2>& a, const std::array<MovingPoint, 2>& b) noexcept {
  const Cubic f = volume(less(a[1], a[0]), less(b[1], b[0]), less(a[0], b[0]));
  return touches_at_root(f, [&](double t) {
    const Vec3 p = a[0].at(t), q = b[0].at(t);
    return segment_distance(p, a[1].at(t) - p, q, b[1].at(t) - q) <= limits::kTouchM;
  });
}

bool segment_meets_triangle(const Vec3& from, const Vec3& to,
                            const std::array<Vec3, 3>& triangle) noexcept {
  const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
  const double before = normal.dot(from - triangle[0]), after = normal.dot(to - triangle[0]);
  if ((before > 0.0 && after > 0.0) || (before < 0.0 && after < 0.0))
    return false;
  const double t = before == after ? 0.5 : before / (before - after);
  const Vec3 p = from + t * (to - from);
  const Vec3 on = nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]).point;
  return (p - on).squaredNorm() <= limits::kTouchM * limits::kTouchM;
}

}  // namespace voxtouch::exact
