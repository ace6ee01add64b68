#include "rig.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "core/mesh/import.hpp"
#include "open_meshes.hpp"
#include "tests/support/exact_shell.hpp"

namespace voxtouch::virtual_tool {

namespace {

double reach_of(const mesh::TriangleMesh& tool) {
  double reach = 0.0;
  for (const Vec3& v : tool.vertices)
    reach = std::max(reach, v.norm());
  return reach;
}

}  // namespace

Rig::Rig(const mesh::TriangleMesh& of, double edge_m, const mesh::TriangleMesh& tool_mesh,
         double lever)
    : mesh(of),
      bodies(tool_mesh,
             std::array{rendering::ExactBodies::Object{.mesh = of, .objects = {0}, .owners = {}}},
             edge_m),
      tool(bodies, 1, lever > 0.0 ? lever : reach_of(tool_mesh)),
      lever_m(lever > 0.0 ? lever : reach_of(tool_mesh)) {}

bool Rig::place(const Pose& at) {
  constexpr int kMostFrames = 100;  // the check of a start may take some frames
  tool.reset();
  tool.start_at(at);
  for (int n = 0; n < kMostFrames && !tool.placed(); ++n)
    frame(at);
  return tool.placed();
}

bool inside(const mesh::TriangleMesh& mesh, const Vec3& x) {
  double angle = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = mesh.corner(t, 0) - x, b = mesh.corner(t, 1) - x, c = mesh.corner(t, 2) - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > 2.0 * std::numbers::pi;
}

mesh::TriangleMesh ball_mesh(double radius_m) { return test::sphere_mesh(radius_m, 4); }
pointshell::Pointshell ball_shell(double edge, double radius_m) {
  return test::exact_shell(ball_mesh(radius_m), edge);
}

Quat tilt() { return Quat(0.961463877, 0.169532022, 0.213151410, -0.037584345).normalized(); }

const Vec3 kBlock(0.06, 0.08, 0.04), kBlockAt(0.3e-3, 0.1e-3, 0.0);

mesh::TriangleMesh scene_mesh(const std::string& name) {
  if (name == "edge")
    return test::box_mesh(kBlock, {kBlockAt, tilt()});
  if (name == "corner")
    return test::joined(
        test::joined(
            test::box_mesh(Vec3(0.08, 0.08, 0.02), {Vec3(0.03, 0.03, -0.01), Quat::Identity()}),
            test::box_mesh(Vec3(0.02, 0.08, 0.06), {Vec3(-0.01, 0.03, 0.02), Quat::Identity()})),
        test::box_mesh(Vec3(0.06, 0.02, 0.06), {Vec3(0.03, -0.01, 0.02), Quat::Identity()}));
  if (name == "plane")
    return test::box_mesh(Vec3(0.12, 0.12, 0.06), {Vec3(0, 0, -0.03), Quat::Identity()});
  if (name == "tilted")
    return test::box_mesh(Vec3(0.12, 0.12, 0.06), {tilt() * Vec3(0, 0, -0.03), tilt()});
  if (name.starts_with("plate:")) {
    const bool askew = name.ends_with(":askew");
    const double thick = std::stod(name.substr(6));
    return test::plate_mesh(0.08, thick,
                            {Vec3(0.37e-3, 0.11e-3, 0.0), askew ? tilt() : Quat::Identity()});
  }
  if (name.starts_with("open:"))
    return open_shape(name.substr(5));
  if (name.starts_with("cylinder:")) {  // with other facets than the shipped one's 96
    mesh::TriangleMesh mesh =
        test::cylinder_mesh(0.04, 0.2, static_cast<std::uint32_t>(std::stoul(name.substr(9))));
    for (Vec3& v : mesh.vertices)
      v = Vec3(v.x(), v.z(), -v.y());
    return mesh;
  }
  return mesh::import_mesh(std::string(VOXTOUCH_DEPLOY "/meshes/") + name + ".obj").mesh;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

Vec3 random_direction(std::mt19937_64& random) {
  for (;;) {
    const Vec3 v(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    if (v.norm() > 0.1 && v.norm() < 1.0)
      return v.normalized();
  }
}

Place random_place(const std::string& scene, const mesh::TriangleMesh& mesh,
                   std::mt19937_64& random) {
  const auto on_face = [&](double top, const Quat& turn) -> Place {
    return {turn * Vec3(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02), top),
            turn * Vec3::UnitZ()};
  };
  if (scene == "edge") {
    const double angle = uniform(random, 5.0, 85.0) * std::numbers::pi / 180.0;
    return {
        kBlockAt + tilt() * Vec3(0.5 * kBlock.x(), uniform(random, -0.02, 0.02), 0.5 * kBlock.z()),
        tilt() * Vec3(std::sin(angle), 0.0, std::cos(angle))};
  }
  if (scene == "corner") {  // the point is where the ball would be on its path from a free place
                            // towards the walls
    const auto within = [&](double low, double high) {
      return Vec3(uniform(random, low, high), uniform(random, low, high),
                  uniform(random, low, high));
    };
    const Vec3 start = within(0.011, 0.02),
               displacement = (start - within(0.0, 0.008)).normalized();
    return {start - (kBall + 0.004) * displacement, displacement};
  }
  if (scene == "plane")
    return on_face(0.0, Quat::Identity());
  if (scene == "tilted")
    return on_face(0.0, tilt());
  if (scene.starts_with("plate:"))
    return on_face(0.5 * std::stod(scene.substr(6)),
                   scene.ends_with(":askew") ? tilt() : Quat::Identity());
  for (;;) {
    std::vector<double> sums;
    double sum = 0.0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      sums.push_back(sum += (mesh.corner(t, 1) - mesh.corner(t, 0))
                                .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                                .norm());
    const auto found = std::lower_bound(sums.begin(), sums.end(), uniform(random, 0.0, sum));
    const auto t = static_cast<std::size_t>(found - sums.begin());
    const double a = std::sqrt(uniform(random, 0, 1)), b = uniform(random, 0, 1);
    Place place;
    place.point =
        (1 - a) * mesh.corner(t, 0) + a * (1 - b) * mesh.corner(t, 1) + a * b * mesh.corner(t, 2);
    place.normal = (mesh.corner(t, 1) - mesh.corner(t, 0))
                       .cross(mesh.corner(t, 2) - mesh.corner(t, 0))
                       .normalized();
    if (scene.starts_with("open:") && random() % 2 == 0)
      place.normal = -place.normal;  // it has no outside
    // Round about its axis only: the ends are planes.
    if (scene.starts_with("cylinder") &&
        (std::abs(place.normal.y()) > 0.5 || std::abs(place.point.y()) > 0.07))
      continue;
    return place;
  }
}

}  // namespace voxtouch::virtual_tool
