#include "tests/bench/bench_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/bench/bench_sizes.hpp"

namespace voxtouch::bench {
namespace {

struct RingPoint {
  double radius, height;  // [voxels]
};
/// From axis to axis, with the solid on its left.
using Profile = std::vector<RingPoint>;

double length(const RingPoint& a, const RingPoint& b) {
  return std::hypot(b.radius - a.radius, b.height - a.height);
}

/// Of the surface that the profile sweeps [voxel faces].
double area(const Profile& profile) {
  double sum = 0.0;
  for (std::size_t n = 1; n < profile.size(); ++n)
    sum += std::numbers::pi * (profile[n - 1].radius + profile[n].radius) *
           length(profile[n - 1], profile[n]);
  return sum;
}

Profile divided(const Profile& corners, double step) {
  Profile out{corners.front()};
  for (std::size_t n = 1; n < corners.size(); ++n) {
    const RingPoint &a = corners[n - 1], &b = corners[n];
    const int pieces = std::max(1, static_cast<int>(std::lround(length(a, b) / step)));
    for (int k = 1; k <= pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      out.push_back({a.radius + t * (b.radius - a.radius), a.height + t * (b.height - a.height)});
    }
  }
  return out;
}

/// Of a circle about the origin, without its first point.
void add_arc(Profile& out, double radius, double from, double to, int pieces) {
  for (int k = 1; k <= pieces; ++k) {
    const double angle = from + (to - from) * k / pieces;
    out.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
}

/// The solid of revolution: poles at both ends, a ring of vertices at each point between.
mesh::TriangleMesh revolved(const Profile& profile, std::uint32_t around) {
  mesh::TriangleMesh out;
  const auto rings = static_cast<std::uint32_t>(profile.size() - 2);
  const auto vertex = [&](std::uint32_t ring, std::uint32_t at) {
    return 1 + (ring - 1) * around + at % around;
  };
  out.vertices.push_back(kEdge * Vec3(0.0, 0.0, profile.front().height));
  for (std::uint32_t ring = 1; ring <= rings; ++ring)
    for (std::uint32_t n = 0; n < around; ++n) {
      const double angle = 2.0 * std::numbers::pi * n / around;
      out.vertices.push_back(kEdge * Vec3(profile[ring].radius * std::cos(angle),
                                          profile[ring].radius * std::sin(angle),
                                          profile[ring].height));
    }
  const auto last = static_cast<std::uint32_t>(out.vertices.size());
  out.vertices.push_back(kEdge * Vec3(0.0, 0.0, profile.back().height));
  for (std::uint32_t n = 0; n < around; ++n) {
    out.triangles.push_back({0, vertex(1, n + 1), vertex(1, n)});
    for (std::uint32_t ring = 1; ring < rings; ++ring) {
      out.triangles.push_back({vertex(ring, n), vertex(ring, n + 1), vertex(ring + 1, n + 1)});
      out.triangles.push_back({vertex(ring, n), vertex(ring + 1, n + 1), vertex(ring + 1, n)});
    }
    out.triangles.push_back({last, vertex(rings, n), vertex(rings, n + 1)});
  }
  return out;
}

std::uint32_t pieces_around(const Profile& profile, double step) {
  double widest = 0.0;
  for (const RingPoint& p : profile)
    widest = std::max(widest, p.radius);
  return std::max(8U,
                  static_cast<std::uint32_t>(std::lround(2.0 * std::numbers::pi * widest / step)));
}

/// Edge [voxels] of a quad of two triangles, for about so many triangles.
double step_for(double surface, std::size_t triangles) {
  return std::sqrt(2.0 * surface / static_cast<double>(triangles));
}

}  // namespace

mesh::TriangleMesh cup_mesh(std::size_t triangles) {
  const Profile corners{{0.0, 0.0},        {kOuter, 0.0},    {kOuter, kHeight},
                        {kInner, kHeight}, {kInner, kFloor}, {0.0, kFloor}};
  const double step = step_for(area(corners), triangles);
  return revolved(divided(corners, step), pieces_around(corners, step));
}

mesh::TriangleMesh tool_mesh(Place place, std::size_t triangles) {
  const double quarter = 0.5 * std::numbers::pi;
  if (place != Place::kHeavy) {
    const double step = step_for(4.0 * std::numbers::pi * kBall * kBall, triangles);
    Profile ball{{0.0, -kBall}};
    add_arc(ball, kBall, -quarter, quarter,
            static_cast<int>(std::lround(2.0 * quarter * kBall / step)));
    return revolved(ball, pieces_around(ball, step));
  }
  const double pi = std::numbers::pi,
               step = step_for(pi * kInner * (3.0 * kInner + 2.0 * kPlugLength), triangles);
  Profile plug{{0.0, -kInner}};
  add_arc(plug, kInner, -quarter, 0.0, static_cast<int>(std::lround(quarter * kInner / step)));
  const Profile rest = divided({plug.back(), {kInner, kPlugLength}, {0.0, kPlugLength}}, step);
  plug.insert(plug.end(), rest.begin() + 1, rest.end());
  return revolved(plug, pieces_around(plug, step));
}

}  // namespace voxtouch::bench
