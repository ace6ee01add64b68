// Effect of the voxel grid's offset on each contact model: planes, corners and thin walls along the
// grid, displaced by random fractions of a voxel, on a grid with borders at multiples of e and on
// an object's default grid.
//
// grid_phase [--phases N] [--places N] [--seed S]        20 s; a row per model and shape
#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/voxmap/object_grid.hpp"
#include "tests/unit/contact/field_scenes.hpp"
#include "tests/unit/contact/fixtures.hpp"

namespace {

using namespace voxtouch;
using contact::ContactModelKind;
using test::uniform;

constexpr double kEdge = 2e-3, kRadius = 5 * kEdge, kDepth = 0.5 * kEdge;
constexpr std::array kModels = {ContactModelKind::kOriginal, ContactModelKind::kAdapted,
                                ContactModelKind::kField};

/// Faces at whole voxels, and the positions of a ball that touches them half a voxel deep.
struct Place {
  std::string name;
  mesh::TriangleMesh mesh;
  std::function<double(const Vec3&)> depth;  ///< of a point, negative outside; 1-Lipschitz
  std::function<Vec3(std::mt19937_64&)> ball_centre;
  std::function<Vec3(const Vec3&)>
      out;  ///< displacement of the exact ball, with this centre, until it is outside
};

double depth_in(const Vec3& size, const Vec3& middle, const Vec3& x) {
  const Vec3 beyond = (x - middle).cwiseAbs() - 0.5 * size;
  return -(beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0));
}

double along(std::mt19937_64& random) { return uniform(random, -0.012, 0.012); }

/// A slab `thick` voxels thick with its top at z = 0; the ball moves in from above.
Place slab(const std::string& name, double thick) {
  const Vec3 size(0.08, 0.08, thick * kEdge), middle(0, 0, -0.5 * thick * kEdge);
  return {
      name, test::box_mesh(size, {middle, Quat::Identity()}),
      [=](const Vec3& x) { return depth_in(size, middle, x); },
      [](std::mt19937_64& random) { return Vec3(along(random), along(random), kRadius - kDepth); },
      [](const Vec3&) { return Vec3(0, 0, kDepth); }};
}

/// A block's edge along y through the origin; the ball approaches at `degrees` from the vertical.
Place convex(const std::string& name, double least_degrees, double most_degrees) {
  const Vec3 size = Vec3::Constant(0.06), middle(-0.03, 0, -0.03);
  return {name, test::box_mesh(size, {middle, Quat::Identity()}),
          [=](const Vec3& x) { return depth_in(size, middle, x); },
          [=](std::mt19937_64& random) {
            const double a = uniform(random, least_degrees, most_degrees) * 3.14159265358979 / 180;
            return Vec3((kRadius - kDepth) * std::sin(a), along(random),
                        (kRadius - kDepth) * std::cos(a));
          },
          [](const Vec3& centre) -> Vec3 {
            return kDepth * Vec3(centre.x(), 0, centre.z()).normalized();
          }};
}

/// Two walls that meet along z, the free space is x, y > 0; the ball lies in it against both.
Place concave() {
  const mesh::TriangleMesh left = test::box_mesh(Vec3(0.02, 0.08, 0.06),
                                                 {Vec3(-0.01, 0.02, 0), Quat::Identity()}),
                           below = test::box_mesh(Vec3(0.08, 0.02, 0.06),
                                                  {Vec3(0.02, -0.01, 0), Quat::Identity()});
  return {"concave corner", test::joined(left, below),
          [](const Vec3& x) {
            return x.x() < 0 && x.y() < 0 ? std::hypot(x.x(), x.y()) : -std::min(x.x(), x.y());
          },
          [](std::mt19937_64& random) {
            return Vec3(kRadius - kDepth, kRadius - kDepth, along(random));
          },
          [](const Vec3&) { return Vec3(kDepth, kDepth, 0); }};
}

struct Touch {
  Pose pose;
  Vec3 truth;
  Vec3 out;  ///< of a virtual tool the truth, over the spring [m]
};

struct Figures {
  double missed = 0.0;     ///< fraction of touches without any force
  double size = 0.0;       ///< mean force over the mean of the law's
  double direction = 0.0;  ///< median error of those with a force [degrees]
};

/// `force_at`: of a touch; `truth_of`: its true value.
template <class Force, class Truth>
Figures judge(const std::vector<Touch>& touches, Force&& force_at, Truth&& truth_of) {
  Figures f;
  double got = 0.0, truth = 0.0;
  std::vector<double> directions;
  for (const Touch& touch : touches) {
    const Vec3 force = force_at(touch);
    got += force.norm(), truth += truth_of(touch).norm();
    if (force.isZero(0.0))
      f.missed += 1.0 / static_cast<double>(touches.size());
    else
      directions.push_back(test::degrees_between(force, truth_of(touch)));
  }
  f.size = got / truth;
  f.direction = directions.empty() ? NAN : test::quantile(directions, 0.5);
  return f;
}

Figures measure(contact::ContactRenderer renderer, const std::vector<Touch>& touches,
                const Vec3& shift) {
  return judge(
      touches,
      [&](const Touch& touch) {
        return renderer.probe({touch.pose.position + shift, touch.pose.orientation}).wrench.force;
      },
      [](const Touch& touch) { return touch.truth; });
}

/// Median and worst over the phases.
std::string summary(const std::vector<Figures>& all) {
  std::vector<double> missed, size, direction;
  for (const Figures& f : all) {
    missed.push_back(f.missed), size.push_back(f.size);
    if (std::isfinite(f.direction))
      direction.push_back(f.direction);
  }
  const auto worst_size = *std::max_element(size.begin(), size.end(), [](double a, double b) {
    return std::abs(a - 1) < std::abs(b - 1);
  });
  return fmt::format("{:3.0f} % {:3.0f} % | {:4.2f} {:4.2f} | {:4.1f} {:4.1f}",
                     100 * test::quantile(missed, 0.5), 100 * test::quantile(missed, 1.0),
                     test::quantile(size, 0.5), worst_size,
                     direction.empty() ? NAN : test::quantile(direction, 0.5),
                     direction.empty() ? NAN : test::quantile(direction, 1.0));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"What the place of the voxel grid does to each contact model"};
  std::uint64_t seed = 1;
  int phases = 50, places = 20;
  app.add_option("--seed", seed, "of phases, places and turns");
  app.add_option("--phases", phases, "random places of the meshes in the grid")
      ->check(CLI::PositiveNumber);
  app.add_option("--places", places, "touches at each phase")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  const test::Ball ball(kRadius, 4);
  const pointshell::Pointshell shell = test::exact_shell(ball.mesh, kEdge);
  const std::vector<Place> all = {slab("plane", 10.0),
                                  convex("right angle, 35 to 45 deg", 35, 45),
                                  convex("right angle, 10 to 80 deg", 10, 80),
                                  concave(),
                                  slab("wall of 0.5 e", 0.5),
                                  slab("wall of 1 e", 1.0),
                                  slab("wall of 1.5 e", 1.5),
                                  slab("wall of 2 e", 2.0)};
  std::mt19937_64 random(seed);
  std::vector<Vec3> shifts;
  for (int n = 0; n < phases; ++n)
    shifts.push_back(kEdge *
                     Vec3(uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)));
  // Whole voxels, and a nanometre off: the effect of rounding on a CAD part with faces on the
  // borders.
  const std::vector<Vec3> on_borders = {Vec3::Zero(), Vec3::Constant(1e-9), Vec3::Constant(-1e-9)};
  fmt::print(
      "seed {}; each: touches missed, force over the law's, direction [deg]: median and worst over "
      "{} phases\n",
      seed, phases);
  for (const Place& place : all) {
    std::vector<Touch> touches;
    for (int n = 0; n < places; ++n) {
      const Quat turn = test::random_rotation(random);
      const Vec3 centre = place.ball_centre(random);
      const Pose pose = ball.posed(centre, turn);
      touches.push_back(
          {pose, test::integral_over(ball.mesh, pose, place.depth).force, place.out(centre)});
    }
    const auto over = [&](const std::vector<Vec3>& moved, auto&& grid_of) {
      std::array<std::vector<Figures>, kModels.size()> figures;
      for (const Vec3& shift : moved) {
        mesh::TriangleMesh mesh = place.mesh;
        for (Vec3& v : mesh.vertices)
          v += shift;
        const test::Ground ground(mesh, grid_of(mesh, kEdge), 12.0);
        for (std::size_t m = 0; m < kModels.size(); ++m)
          figures[m].push_back(measure(ground.renderer(shell, kModels[m]), touches, shift));
      }
      return figures;
    };
    const auto borders = over(on_borders, voxmap::default_grid),
               before = over(shifts, voxmap::default_grid),
               after = over(shifts, voxmap::object_grid);
    for (std::size_t m = 0; m < kModels.size(); ++m)
      fmt::print("{:26} {:12} | faces on borders {} || multiples of e {} || clear of faces {}\n",
                 place.name, contact::name_of(kModels[m]), summary(borders[m]), summary(before[m]),
                 summary(after[m]));
    std::fflush(stdout);
  }
}
