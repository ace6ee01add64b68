#include "field_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"

namespace voxtouch::test {
namespace {

/// The integral of max(0, depth) n over one triangle, by its quarters' quarters' quarters' middles.
void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, int splits, const Vec3& origin,
                  const std::function<double(const Vec3&)>& depth, Wrench& sum) {
  const Vec3 middle = (a + b + c) / 3.0;
  const double reach = std::max({(a - middle).norm(), (b - middle).norm(), (c - middle).norm()});
  const double deep = depth(middle);
  if (deep + reach <= 0.0)
    return;
  if (splits == 0) {
    const Vec3 force = kPressure * std::max(0.0, deep) * -0.5 * (b - a).cross(c - a);
    sum.force += force;
    sum.torque += (middle - origin).cross(force);
    return;
  }
  const Vec3 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
  add_triangle(a, ab, ca, splits - 1, origin, depth, sum);
  add_triangle(ab, b, bc, splits - 1, origin, depth, sum);
  add_triangle(ca, bc, c, splits - 1, origin, depth, sum);
  add_triangle(ab, bc, ca, splits - 1, origin, depth, sum);
}

}  // namespace

mesh::TriangleMesh box_mesh(const Vec3& size, const Pose& pose) {
  mesh::TriangleMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.push_back(pose *
                            (0.5 * Vec3(n & 1 ? size.x() : -size.x(), n & 2 ? size.y() : -size.y(),
                                        n & 4 ? size.z() : -size.z())));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

mesh::TriangleMesh plate_mesh(double wide_m, double thick_m, const Pose& pose) {
  if (thick_m > 0.0)
    return box_mesh(Vec3(wide_m, wide_m, thick_m), pose);
  mesh::TriangleMesh sheet;
  for (const Vec3& v : {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)})
    sheet.vertices.push_back(pose * (0.5 * wide_m * v));
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  return sheet;
}

mesh::TriangleMesh sphere_mesh(double radius_m, int splits) {
  const double g = std::numbers::phi;
  mesh::TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int n = 0; n < splits; ++n) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (fresh)
        mesh.vertices.push_back(
            (mesh.vertices[a].normalized() + mesh.vertices[b].normalized()).normalized());
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::array<std::uint32_t, 3>& t :
           {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices)
    v = radius_m * v.normalized();
  return mesh;
}

mesh::TriangleMesh cylinder_mesh(double radius_m, double length_m, int sides) {
  mesh::TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t s = 0; s < n; ++s)
    for (const double z : {-0.5, 0.5}) {
      const double angle = 2.0 * std::numbers::pi * s / n;
      mesh.vertices.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle),
                                 z * length_m);
    }
  mesh.vertices.emplace_back(0, 0, -0.5 * length_m);
  mesh.vertices.emplace_back(0, 0, 0.5 * length_m);
  for (std::uint32_t s = 0; s < n; ++s) {
    const std::uint32_t a = 2 * s, b = 2 * ((s + 1) % n);
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{a, b, b + 1}, {a, b + 1, a + 1}, {b, a, 2 * n}, {a + 1, b + 1, 2 * n + 1}});
  }
  return mesh;
}

mesh::TriangleMesh joined(const mesh::TriangleMesh& a, const mesh::TriangleMesh& b) {
  mesh::TriangleMesh mesh = a;
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return mesh;
}

mesh::TriangleMesh inside_out(mesh::TriangleMesh mesh) {
  for (auto& t : mesh.triangles)
    std::swap(t[1], t[2]);
  return mesh;
}

Ground::Ground(const mesh::TriangleMesh& mesh, double edge, double depth_voxels)
    : Ground(mesh, voxmap::default_grid(mesh, edge), depth_voxels) {}

Ground::Ground(const mesh::TriangleMesh& mesh, const voxmap::Grid& grid, double depth_voxels)
    : voxmap(voxmap::voxelise(mesh, grid, serial_for())),
      field(voxmap::build_distance_field(
          mesh, voxmap, {.depth_voxels = depth_voxels, .band_voxels = 2.0}, serial_for())) {}

contact::ContactRenderer Ground::renderer(const pointshell::Pointshell& tool,
                                          contact::ContactModelKind kind, bool memoryless) const {
  return {voxmap, tool, kind, {kPressure, contact::PointWeights::kArea, memoryless}, &field};
}

Ball::Ball(double radius_m, int splits)
    : mesh(sphere_mesh(radius_m, splits)),
      centre(0.37e-3, -0.81e-3, 0.19e-3) {
  const Quat askew(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  for (Vec3& v : mesh.vertices)
    v = askew * v + centre;
}

Wrench integral_over(const mesh::TriangleMesh& tool, const Pose& pose,
                     const std::function<double(const Vec3&)>& depth) {
  Wrench sum;
  for (const auto& t : tool.triangles)
    add_triangle(pose * tool.vertices[t[0]], pose * tool.vertices[t[1]], pose * tool.vertices[t[2]],
                 3, pose.position, depth, sum);
  return sum;
}

double quantile(std::vector<double> values, double fraction) {
  const auto place = values.begin() +
                     static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double v : values)
    squares += v * v;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

double noise(const std::vector<double>& values) {
  double sum = 0.0, squares = 0.0;
  for (const double v : values)
    sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values)
    squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size())) / mean;
}

double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

}  // namespace voxtouch::test
