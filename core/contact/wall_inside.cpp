#include "core/contact/wall_inside.hpp"

#include "core/contact/limits.hpp"

namespace voxtouch::contact {
namespace {

/// A point of the static object, in grid coordinates, and the normal of the thin wall around it;
/// zero: it is in the interior that the field represents.
struct WallPoint {
  Vec3 at, normal;
};

/// Searches for a wall at `u`, and within an edge of it for the middle of a thin wall, from which
/// the distance grows to either side.
bool find_wall(const voxmap::DistanceField& field, const Vec3& u, WallPoint& wall) noexcept {
  wall = {u, Vec3::Zero()};
  if (field.at(u).distance_m < 0.0)
    return true;
  double widest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const voxmap::FieldSample above = field.at(u + Vec3::Unit(axis)),
                              below = field.at(u - Vec3::Unit(axis));
    const double lengths = above.gradient.norm() * below.gradient.norm(),
                 apart = above.distance_m + below.distance_m;
    if (!(above.gradient[axis] > 0.0 && below.gradient[axis] < 0.0 &&
          above.gradient.dot(below.gradient) < -limits::kOpposed * lengths))
      continue;
    if (!(above.distance_m > 0.0 && below.distance_m > 0.0 && apart > widest))
      continue;
    widest = apart;
    wall.normal = (above.gradient - below.gradient).normalized();
    wall.at = u + (0.5 / field.grid().edge) * (below.distance_m - above.distance_m) * wall.normal;
  }
  return widest > 0.0;
}

/// Whether a point, `arm` from the tool's origin, is deeper inside the tool than a start allows, by
/// the hits near it; at least one is required. Searches from hit `from` to both sides, since
/// neighbours in the list are neighbours in the tool. A single hit can refute it.
bool deep_inside(const Hits& hits, std::size_t from, const Vec3& arm, double edge) noexcept {
  const double near = limits::kNearEdges * edge, depth = limits::kPlacedDepthEdges * edge;
  bool any = false;
  for (std::size_t k = 0; k < 2 * hits.size(); ++k) {
    const std::size_t n =
        k % 2 == 0 ? from + k / 2 : from - k / 2 - 1;  // negative values are beyond the end
    if (n >= hits.size())
      continue;
    const Hit hit = hits[n];
    const Vec3 inward = arm - hit.arm;
    if (!(inward.squaredNorm() < near * near))
      continue;
    if (!(inward.dot(hit.normal) > depth))
      return false;
    any = true;
  }
  return any;
}

}  // namespace

bool wall_inside_tool(const Hits& hits, const voxmap::DistanceField& field,
                      const Vec3& local) noexcept {
  const double edge = field.grid().edge;
  WallPoint wall;
  for (std::size_t n = 0, step = 1 + hits.size() / limits::kMostAsked; n < hits.size(); n += step) {
    const Hit hit = hits[n];
    Vec3 u = (local + hit.arm) / edge;
    for (int farther = 0; farther <= limits::kStepsIn && find_wall(field, u, wall); ++farther) {
      if (farther > 0 && deep_inside(hits, n, edge * wall.at - local, edge))
        return true;
      const Vec3 along = hit.normal - hit.normal.dot(wall.normal) * wall.normal;
      if (!(along.squaredNorm() > limits::kShortestAlong * limits::kShortestAlong))
        break;
      u = wall.at + limits::kStepInEdges * along.normalized();
    }
  }
  return false;
}

}  // namespace voxtouch::contact
