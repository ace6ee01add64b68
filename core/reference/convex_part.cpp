#include "core/reference/convex_part.hpp"

#include <algorithm>
#include <limits>

namespace voxtouch::reference {
namespace {

Vec3 on_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = along.squaredNorm();
  return square > 0.0 ? Vec3(a + std::clamp((x - a).dot(along) / square, 0.0, 1.0) * along) : a;
}

/// The foot on the plane if it lies within all three edges, otherwise the nearest point of an edge.
Vec3 on_face(const Vec3& x, const std::array<Vec3, 3>& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  bool within = normal.squaredNorm() > 0.0;
  for (std::size_t k = 0; k < 3 && within; ++k)
    within = (t[(k + 1) % 3] - t[k]).cross(x - t[k]).dot(normal) >= 0.0;
  if (within)
    return x - (x - t[0]).dot(normal) / normal.squaredNorm() * normal;
  Vec3 best = on_segment(x, t[0], t[1]);
  for (const Vec3& other : {on_segment(x, t[1], t[2]), on_segment(x, t[2], t[0])})
    if ((x - other).squaredNorm() < (x - best).squaredNorm())
      best = other;
  return best;
}

Nearness between(const Vec3& mine, const Vec3& other) {
  return {(mine - other).norm(), mine, other};
}

/// The common perpendicular if both its feet lie on the segments, otherwise the best of the four
/// ends.
Nearness of_segments(const ConvexPart& mine, const ConvexPart& other) {
  const Vec3 &a = mine.corner[0], &b = mine.corner[1], &c = other.corner[0], &d = other.corner[1];
  Nearness best = between(a, on_segment(a, c, d));
  for (const Nearness& end : {between(b, on_segment(b, c, d)), between(on_segment(c, a, b), c),
                              between(on_segment(d, a, b), d)})
    if (end.distance_m < best.distance_m)
      best = end;
  const Vec3 u = b - a, v = d - c, across = u.cross(v);
  const double square = across.squaredNorm();
  if (!(square > 0.0))
    return best;
  const double s = (c - a).cross(v).dot(across) / square;
  const double t = (c - a).cross(u).dot(across) / square;
  if (s < 0.0 || s > 1.0 || t < 0.0 || t > 1.0)
    return best;
  const Nearness inner = between(a + s * u, c + t * v);
  return inner.distance_m < best.distance_m ? inner : best;
}

}  // namespace

Nearness nearness(const ConvexPart& mine, const ConvexPart& other) {
  if (mine.corners == 1)
    return between(mine.corner[0], on_face(mine.corner[0], other.corner));
  if (other.corners == 1)
    return between(on_face(other.corner[0], mine.corner), other.corner[0]);
  return of_segments(mine, other);
}

double separation(const ConvexPart& mine, const ConvexPart& other, const Vec3& direction) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (std::size_t k = 0; k < mine.corners; ++k)
    least = std::min(least, direction.dot(mine.corner[k]));
  for (std::size_t k = 0; k < other.corners; ++k)
    most = std::max(most, direction.dot(other.corner[k]));
  return least - most;
}

}  // namespace voxtouch::reference
