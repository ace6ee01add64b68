#pragma once
/// Nearest points of points, segments and triangles (Ericson, Real-Time Collision Detection,
/// 2005, 5.1). All real-time safe.
#include <algorithm>
#include <cstdint>

#include "core/types/geometry.hpp"

namespace voxtouch::exact {

/// Where on a triangle a point lies: kCorner + k, kSide + k (side k joins corner k and the next),
/// or within.
namespace region {
inline constexpr int kCorner = 0, kSide = 3, kFace = 6;
}

struct OnTriangle {
  Vec3 point = Vec3::Zero();
  int region = region::kFace;
};

/// The point of the triangle a b c that is nearest to `p`.
inline OnTriangle nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b,
                                      const Vec3& c) noexcept {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0)
    return {a, region::kCorner};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3)
    return {b, region::kCorner + 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
    return {a + (d1 / (d1 - d3)) * ab, region::kSide};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6)
    return {c, region::kCorner + 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
    return {a + (d2 / (d2 - d6)) * ac, region::kSide + 2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b), region::kSide + 1};
  const double sum = 1.0 / (va + vb + vc);
  return {a + (vb * sum) * ab + (vc * sum) * ac, region::kFace};
}

/// Parameters, 0 to 1, of the nearest points of two segments.
struct OnSegments {
  double s = 0.0, t = 0.0;
};

/// Of p + s u and q + t v. Neither may have length zero.
inline OnSegments nearest_on_segments(const Vec3& p, const Vec3& u, const Vec3& q,
                                      const Vec3& v) noexcept {
  const Vec3 r = p - q;
  const double a = u.dot(u), e = v.dot(v), f = v.dot(r), c = u.dot(r), b = u.dot(v);
  const double denominator = a * e - b * b;
  double s = 0.0;
  if (denominator > 1e-14 * a * e)
    s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  return {s, t};
}

inline double segment_distance(const Vec3& p, const Vec3& u, const Vec3& q,
                               const Vec3& v) noexcept {
  const OnSegments at = nearest_on_segments(p, u, q, v);
  return (p + at.s * u - q - at.t * v).norm();
}

/// Squared distance of `p` from the segment from `a` along `u`, which may have length zero.
inline double point_segment_distance2(const Vec3& p, const Vec3& a, const Vec3& u) noexcept {
  const double length2 = u.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp(u.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * u).squaredNorm();
}

}  // namespace voxtouch::exact
