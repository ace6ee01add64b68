#include "core/voxmap/exact_sign.hpp"

#include <array>
#include <cmath>

namespace voxtouch::voxmap {
namespace {

constexpr double kEps = 0x1p-53;
constexpr double kBound2d = (3.0 + 16.0 * kEps) * kEps;  // Shewchuk's ccwerrboundA
constexpr double kBound3d = (7.0 + 56.0 * kEps) * kEps;  // Shewchuk's o3derrboundA

/// A sum of nonoverlapping doubles in increasing magnitude; its value is the exact sum.
template <int N>
struct Expansion {
  std::array<double, N> part;
  int size = 0;

  /// Adds one double exactly (grow-expansion with zero elimination).
  void add(double b) noexcept {
    double carry = b;
    int out = 0;
    for (int i = 0; i < size; ++i) {
      const double sum = carry + part[i];
      const double virtual_b = sum - carry;
      const double error = (carry - (sum - virtual_b)) + (part[i] - virtual_b);
      carry = sum;
      if (error != 0.0)
        part[out++] = error;
    }
    if (carry != 0.0)
      part[out++] = carry;
    size = out;
  }
  template <int M>
  void add(const Expansion<M>& other, double sign) noexcept {
    for (int i = 0; i < other.size; ++i)
      add(sign * other.part[i]);
  }
  double value() const noexcept {
    double sum = 0.0;
    for (int i = 0; i < size; ++i)
      sum += part[i];
    return sum;  // the sign is that of the largest part, which is added last
  }
};

Expansion<2> difference(double a, double b) noexcept {
  Expansion<2> d;
  d.add(a);
  d.add(-b);
  return d;
}

template <int N, int M>
Expansion<2 * N * M> product(const Expansion<N>& a, const Expansion<M>& b) noexcept {
  Expansion<2 * N * M> p;
  for (int i = 0; i < a.size; ++i)
    for (int j = 0; j < b.size; ++j) {
      const double high = a.part[i] * b.part[j];
      p.add(std::fma(a.part[i], b.part[j], -high));
      p.add(high);
    }
  return p;
}

Expansion<16> minor(const Expansion<2>& ax, const Expansion<2>& ay, const Expansion<2>& bx,
                    const Expansion<2>& by) noexcept {
  Expansion<16> m;
  m.add(product(ax, by), 1.0);
  m.add(product(ay, bx), -1.0);
  return m;
}

double orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) noexcept {
  std::array<Expansion<2>, 3> d, e, f;
  for (int axis = 0; axis < 3; ++axis) {
    d[axis] = difference(a[axis], p[axis]);
    e[axis] = difference(b[axis], p[axis]);
    f[axis] = difference(c[axis], p[axis]);
  }
  Expansion<192> sum;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    sum.add(product(d[axis], minor(e[next], e[last], f[next], f[last])), -1.0);
  }
  return sum.value();
}

}  // namespace

double orient2d(double ax, double ay, double bx, double by, double px, double py) noexcept {
  const double left = (ax - px) * (by - py), right = (ay - py) * (bx - px);
  const double det = left - right;
  if (std::abs(det) > kBound2d * (std::abs(left) + std::abs(right)))
    return det;
  if (left == 0.0 && right == 0.0 && (ax == px || by == py) && (ay == py || bx == px))
    return 0.0;
  return minor(difference(ax, px), difference(ay, py), difference(bx, px), difference(by, py))
      .value();
}

double orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) noexcept {
  const Vec3 d = a - p, e = b - p, f = c - p;
  double det = 0.0, permanent = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const double left = e[next] * f[last], right = e[last] * f[next];
    det += d[axis] * (left - right);
    permanent += std::abs(d[axis]) * (std::abs(left) + std::abs(right));
  }
  if (std::abs(det) > kBound3d * permanent)
    return -det;
  return orient3d_exact(a, b, c, p);
}

namespace {

/// As `orient2d`, but with a relative error below 2^-37 in addition to the exact sign.
double accurate2d(double ax, double ay, double bx, double by, double px, double py) noexcept {
  const double left = (ax - px) * (by - py), right = (ay - py) * (bx - px);
  const double det = left - right;
  if (std::abs(det) > 0x1p-13 * (std::abs(left) + std::abs(right)))
    return det;
  if (left == 0.0 && right == 0.0)
    return orient2d(ax, ay, bx, by, px, py);
  return minor(difference(ax, px), difference(ay, py), difference(bx, px), difference(by, py))
      .value();
}

}  // namespace

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return {accurate2d(a.y(), a.z(), b.y(), b.z(), c.y(), c.z()),
          accurate2d(a.z(), a.x(), b.z(), b.x(), c.z(), c.x()),
          accurate2d(a.x(), a.y(), b.x(), b.y(), c.x(), c.y())};
}

}  // namespace voxtouch::voxmap
