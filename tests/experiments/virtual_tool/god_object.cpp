#include "god_object.hpp"

#include <algorithm>
#include <limits>

namespace voxtouch::virtual_tool {
namespace {

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = (p - a).dot(b - a) / (b - a).squaredNorm();
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

Vec3 nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const bool in = (b - a).cross(p - a).dot(n) >= 0.0 && (c - b).cross(p - b).dot(n) >= 0.0 &&
                  (a - c).cross(p - c).dot(n) >= 0.0;
  if (in && n.squaredNorm() > 0.0)
    return p - n * (n.dot(p - a) / n.squaredNorm());
  Vec3 best = nearest_on_segment(p, a, b);
  for (const Vec3& q : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)})
    if ((q - p).squaredNorm() < (best - p).squaredNorm())
      best = q;
  return best;
}

struct Wall {
  Vec3 normal;
  double room, push;
};

/// The least change of `displacement` that respects all walls: Hildreth's method on the
/// multipliers.
Vec3 kept_out(const Vec3& displacement, std::vector<Wall>& walls) {
  Vec3 out = displacement;
  for (int sweep = 0; sweep < 2000; ++sweep) {
    double most = 0.0;
    for (Wall& wall : walls) {
      const double push = std::max(0.0, wall.push - (wall.normal.dot(out) + wall.room));
      out += (push - wall.push) * wall.normal;
      most = std::max(most, std::abs(push - wall.push));
      wall.push = push;
    }
    if (most < 1e-12)
      break;
  }
  return out;
}

}  // namespace

double GodObject::distance(const Vec3& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    least = std::min(
        least,
        (nearest_on_triangle(x, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)) - x)
            .norm());
  return least;
}

void GodObject::place(const Vec3& centre, double range_m) {
  centre_ = centre;
  near_.clear();
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
    if ((nearest_on_triangle(centre, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)) -
         centre)
            .norm() < range_m)
      near_.push_back(t);
}

const Vec3& GodObject::draw_to(const Vec3& hand) {
  constexpr double kStep = 0.2e-3;
  std::vector<Wall> walls;
  for (int n = 0; n < 300; ++n) {
    walls.clear();
    for (const std::size_t t : near_) {
      const Vec3 from = centre_ - nearest_on_triangle(centre_, mesh_.corner(t, 0),
                                                      mesh_.corner(t, 1), mesh_.corner(t, 2));
      if (const double far = from.norm(); far < radius_m_ + 2.0 * kStep)
        walls.push_back({from / far, far - radius_m_, 0.0});
    }
    Vec3 displacement = kept_out(hand - centre_, walls);
    if (const double length = displacement.norm(); length > kStep)
      displacement *= kStep / length;
    centre_ += displacement;
    if (displacement.norm() < 1e-8)
      break;
  }
  return centre_;
}

}  // namespace voxtouch::virtual_tool
