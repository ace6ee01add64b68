#include "core/pointshell/clip.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::pointshell {
namespace {

/// A foot this near a side, relative to the lengths involved, is left to the search along the
/// sides, which is right there: so a sliver's sides, all "inside" by rounding, cannot make a point
/// beyond its end pass.
constexpr double kOnSide = 1e-14;

/// Keeps the part with side * x[axis] <= limit.
void cut(VoxelPolygon& polygon, int axis, double side, double limit) noexcept {
  bool all_inside = true;
  for (int n = 0; n < polygon.size; ++n)
    all_inside = all_inside && side * polygon.corner[n][axis] <= limit;
  if (all_inside)
    return;
  VoxelPolygon kept;
  for (int n = 0; n < polygon.size; ++n) {
    const Vec3& from = polygon.corner[n];
    const Vec3& to = polygon.corner[n + 1 == polygon.size ? 0 : n + 1];
    const double at_from = side * from[axis] - limit, at_to = side * to[axis] - limit;
    if (at_from <= 0.0 && kept.size < 9)
      kept.corner[kept.size++] = from;
    if (((at_from < 0.0 && at_to > 0.0) || (at_from > 0.0 && at_to < 0.0)) && kept.size < 9) {
      // From the nearer end, so that a long edge loses no accuracy and both triangles of an edge
      // agree.
      Vec3 x = std::abs(at_from) < std::abs(at_to)
                   ? Vec3(from + (at_from / (at_from - at_to)) * (to - from))
                   : Vec3(to + (at_to / (at_to - at_from)) * (from - to));
      x[axis] = side * limit;
      kept.corner[kept.size++] = x;
    }
  }
  polygon = kept;
}

/// Rounding error of the triangle's coordinates.
double rounding_of(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  return 0x1p-53 *
         std::max({1.0, a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
}

VoxelPolygon clip(const Vec3& a, const Vec3& b, const Vec3& c, double limit) noexcept {
  VoxelPolygon polygon;
  polygon.corner[0] = a, polygon.corner[1] = b, polygon.corner[2] = c;
  polygon.size = 3;
  for (int axis = 0; axis < 3 && polygon.size > 0; ++axis) {
    cut(polygon, axis, 1.0, limit);
    cut(polygon, axis, -1.0, limit);
  }
  return polygon;
}

}  // namespace

VoxelPolygon clip_to_voxel(const Vec3& a, const Vec3& b, const Vec3& c) noexcept {
  VoxelPolygon polygon = clip(a, b, c, 0.5);
  for (double tolerance = rounding_of(a, b, c); polygon.size == 0; tolerance *= 4.0)
    polygon = clip(a, b, c, 0.5 + tolerance);
  return polygon;
}

double area(const VoxelPolygon& polygon) noexcept {
  Vec3 sum = Vec3::Zero();
  for (int n = 2; n < polygon.size; ++n)
    sum += (polygon.corner[n - 1] - polygon.corner[0]).cross(polygon.corner[n] - polygon.corner[0]);
  return 0.5 * sum.norm();
}

Vec3 nearest_to_centre(const std::array<Vec3, 3>& triangle, const Vec3& normal,
                       const VoxelPolygon& polygon) noexcept {
  // Uses the triangle and the cube, not the polygon: the direction of its short sides is
  // inaccurate.
  const Vec3 nearest = normal * normal.dot(triangle[0]);
  bool inside = nearest.cwiseAbs().maxCoeff() <= 0.5 && !normal.isZero(0.0);
  for (std::size_t n = 0; n < 3 && inside; ++n) {
    const Vec3 side = triangle[(n + 1) % 3] - triangle[n], to_nearest = nearest - triangle[n];
    inside = normal.dot(side.cross(to_nearest)) > kOnSide * side.norm() * (1.0 + to_nearest.norm());
  }
  if (inside)
    return nearest;

  // Along an edge or face of the cube that they only touch, rounding may have cut away all but an
  // end.
  VoxelPolygon wider;
  const bool touch_only = area(polygon) <= kTouchArea;
  if (touch_only) {
    const double tolerance = 4.0 * rounding_of(triangle[0], triangle[1], triangle[2]);
    wider = clip(triangle[0], triangle[1], triangle[2], 0.5 + tolerance);
  }
  const VoxelPolygon& around = touch_only && wider.size > 0 ? wider : polygon;
  Vec3 best = around.corner[0];
  double best_square = best.squaredNorm();
  for (int n = 0; n < around.size; ++n) {
    const Vec3& from = around.corner[n];
    const Vec3 along = around.corner[n + 1 == around.size ? 0 : n + 1] - from;
    const double square = along.squaredNorm();
    const double t = square > 0.0 ? std::clamp(-from.dot(along) / square, 0.0, 1.0) : 0.0;
    const Vec3 x = from + t * along;
    if (const double distance = x.squaredNorm(); distance < best_square)
      best = x, best_square = distance;
  }
  return best.cwiseMax(-0.5).cwiseMin(0.5);
}

}  // namespace voxtouch::pointshell
