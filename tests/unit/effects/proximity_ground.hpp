#pragma once
/// Static meshes and a tool for the tests of the effect `proximity`.
#include <cmath>
#include <numbers>

#include "core/rendering/proximity_field.hpp"
#include "core/voxmap/voxelise.hpp"
#include "effect_check.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::test {

inline constexpr double kEdge = 0.002;

inline rendering::ProximityField ground_of(const mesh::TriangleMesh& mesh, double range,
                                           double smoothing) {
  return {mesh, voxmap::voxelise(mesh, voxmap::default_grid(mesh, kEdge), serial_for()), range,
          smoothing, serial_for()};
}
/// 60 x 60 x 40 mm round the origin, on the grid and across it.
inline mesh::TriangleMesh block_mesh(const Quat& turn = Quat::Identity()) {
  return box_mesh({0.06, 0.06, 0.04}, {Vec3::Zero(), turn});
}

/// Equal fractions of a ball round `centre` in T, on a spiral.
inline std::vector<effects::ToolPoint> ball(double radius, std::size_t count,
                                            const Vec3& centre = Vec3::Zero()) {
  std::vector<effects::ToolPoint> points;
  for (std::size_t n = 0; n < count; ++n) {
    const double z = 1.0 - (2.0 * static_cast<double>(n) + 1.0) / static_cast<double>(count),
                 r = std::sqrt(1.0 - z * z);
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * static_cast<double>(n);
    points.push_back({centre + radius * Vec3(r * std::cos(turn), r * std::sin(turn), z),
                      1.0 / static_cast<double>(count)});
  }
  return points;
}

/// Signed distance to a box of `size` round the origin.
inline double box_distance(const Vec3& x, const Vec3& size) {
  const Vec3 q = x.cwiseAbs() - 0.5 * size;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

inline effects::EffectSpec proximity(double limit, double range, double smoothing,
                                     double lever = 0.0) {
  return effect("proximity", {{"limit_n", {limit, 0, 0}},
                              {"range_m", {range, 0, 0}},
                              {"smoothing_m", {smoothing, 0, 0}},
                              {"lever_m", {lever, 0, 0}}});
}

}  // namespace voxtouch::test
