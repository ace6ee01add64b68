#include "tests/experiments/paper/contact_cases.hpp"

#include <cmath>
#include <numbers>

#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"

namespace voxtouch::paper {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

Ground::Ground(const mesh::TriangleMesh& mesh)
    : voxmap(voxmap::voxelise(mesh, voxmap::default_grid(mesh, kEdge), serial_for())),
      field(voxmap::build_distance_field(mesh, voxmap, {.depth_voxels = 3.0, .band_voxels = 2.0},
                                         serial_for())) {}

Sphere::Sphere(const Vec3& grid_shift) : mesh(test::sphere_mesh(kRadius, 5)) {
  voxmap::Grid grid = voxmap::default_grid(mesh, kEdge);
  grid.origin -= kEdge * grid_shift;
  const std::vector<pointshell::ShellPoint> points =
      pointshell::shell_points(mesh, grid, serial_for());
  exact = pointshell::make_exact_shell(points, grid);
  naive = pointshell::make_naive_shell(points, grid);
}

std::vector<ContactCase> all_contact_cases() {
  using enum contact::ContactModelKind;
  using enum contact::PointWeights;
  return {{"original", kOriginal, kOne},
          {"adapted", kAdapted, kOne},
          {"original, area weights", kOriginal, kArea},
          {"adapted, area weights", kAdapted, kArea},
          {"field", kField, kArea}};
}

contact::ContactRenderer renderer_of(const ContactCase& contact_case, const Ground& ground,
                                     const Sphere& sphere) {
  return {ground.voxmap,
          contact_case.naive ? sphere.naive : sphere.exact,
          contact_case.model,
          {1.0, contact_case.weights},
          &ground.field};
}

Slide circle_on_plane(const std::string& name, const Quat& turn, double up_its_voxel,
                      double depth_edges, const Quat& ball) {
  constexpr double kHalf = 0.02;
  // Half a voxel from a border at 0.5; the other faces of the slab have arbitrary offsets.
  const Pose pose{Vec3(0.0007, 0.0011, kEdge * up_its_voxel - kHalf), turn};
  Slide slide;
  slide.name = name;
  slide.mesh = test::box_mesh(Vec3(0.16, 0.16, 2 * kHalf), pose);
  slide.centre = [pose, depth_edges](double s) {
    const double r = 10 * kEdge, a = kTurn * s;
    return pose * Vec3(r * std::cos(a), r * std::sin(a), kHalf + kRadius - depth_edges * kEdge);
  };
  slide.normal = [turn](double) { return Vec3(turn * Vec3::UnitZ()); };
  slide.turn = ball;
  return slide;
}

Slide round_a_cylinder(double radius_m, double depth_edges, const Quat& ball, double along_m) {
  Slide slide;
  slide.name = "cylinder";
  slide.mesh = test::cylinder_mesh(radius_m, 0.12, 720);
  slide.centre = [=](double s) {
    const double r = radius_m + kRadius - depth_edges * kEdge, a = kTurn * s;
    return Vec3(r * std::cos(a), r * std::sin(a), along_m);
  };
  slide.normal = [](double s) { return Vec3(std::cos(kTurn * s), std::sin(kTurn * s), 0); };
  slide.turn = ball;
  return slide;
}

Distraction distraction(contact::ContactRenderer renderer, const Slide& slide, int steps) {
  Distraction out;
  Vec3 mean_across = Vec3::Zero();
  std::vector<Vec3> turned;  // relative to the normal, so that a constant force has a mean
  for (int n = 0; n < steps; ++n) {
    const double s = static_cast<double>(n) / steps;
    const Vec3 normal = slide.normal(s),
               force = renderer.probe({slide.centre(s), slide.turn}).wrench.force;
    out.along.push_back(force.dot(normal));
    out.across.push_back(force - out.along.back() * normal);
    out.mean += out.along.back() / steps;
    turned.push_back(Quat::FromTwoVectors(normal, slide.normal(0)) * out.across.back());
    mean_across += turned.back() / steps;
  }
  double squares = 0.0, about = 0.0;
  for (int n = 0; n < steps; ++n) {
    squares += out.across[static_cast<std::size_t>(n)].squaredNorm() / steps;
    about += (turned[static_cast<std::size_t>(n)] - mean_across).squaredNorm() / steps;
  }
  out.rms = std::sqrt(squares) / out.mean;
  out.rms_about_mean = std::sqrt(about) / out.mean;
  out.noise = test::noise(out.along);
  return out;
}

}  // namespace voxtouch::paper
