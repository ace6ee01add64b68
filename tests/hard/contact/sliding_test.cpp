// Sliding over voxel borders generates energy: its upper bound, and the account of the coupling's
// observer.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/coupling/passivity.hpp"
#include "core/coupling/running_coupling.hpp"
#include "core/rendering/series_spring.hpp"
#include "tests/experiments/stability_map/sliding_loop.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::sliding {
namespace {

constexpr std::array kModels = {contact::ContactModelKind::kOriginal,
                                contact::ContactModelKind::kAdapted,
                                contact::ContactModelKind::kField};

/// Largest energy gain from sliding over voxels, relative to force and path, times the contact
/// radius in voxels.
constexpr double kSlidingRatio = 0.15;

/// The bound of deploy/pictures/stability_map.png: energy generated on a closed loop, divided by
/// mean force times path, for a ball of `radius_voxels`. core/coupling/passivity.hpp states the
/// same.
double most_ratio(contact::ContactModelKind model, double radius_voxels) {
  switch (model) {
    case contact::ContactModelKind::kOriginal:
    case contact::ContactModelKind::kAdapted:
      return kSlidingRatio / radius_voxels;
    case contact::ContactModelKind::kField:
      return radius_voxels < 5.0 ? 0.4 * kSlidingRatio / radius_voxels : 1e-6;
  }
  return 0.0;
}

TEST(F2SlidingOverVoxelBorders, ClosedLoopEnergyIsBounded) {
  const std::uint64_t seed = voxtouch::testing::seed(7);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  for (const double radius : {2.5, 5.0, 10.0})
    for (const double tilt : {0.0, 2.0, 15.0, 45.0}) {
      const Bench bench(radius, tilt);
      for (const contact::ContactModelKind model : kModels)
        for (const double depth : {0.25, 0.5, 1.5}) {
          const Created made = bench.worst_loop(model, depth, 1, seed);
          EXPECT_LE(made.fraction, most_ratio(model, radius))
              << contact::name_of(model) << " R/e " << radius << " depth " << depth << " tilt "
              << tilt;
          // The bound of the row: k e^2 for each point and crossing.
          EXPECT_LE(made.per_crossing, 0.01) << contact::name_of(model) << " R/e " << radius
                                             << " depth " << depth << " tilt " << tilt;
        }
    }
}

struct Slid {
  double lowest_j = 0.0;  ///< translation, of the observer
  double largest_n = 0.0, path_m = 0.0, longest_m = 0.0, mean_n = 0.0;
};

/// A passive hand slides in circles at `speed`, 1 kHz; the observer counts the commands.
Slid slide(const Bench& bench, contact::ContactModelKind model, double depth_voxels, double speed,
           int rounds) {
  constexpr double kPeriod = 1e-3, kRound = 3e-3;
  contact::ContactRenderer contact = bench.renderer(model);
  coupling::CouplingSpec spec;
  spec.kind = "direct";
  spec.velocity_filter_hz = 100.0;
  coupling::RunningCoupling coupling(spec, {.max_force_n = 1e4, .max_torque_nm = 1e3}, kPeriod,
                                     1e-3, {1e3, 1e3});
  Slid out;
  const double depth = depth_voxels * bench.edge_m(), turn = speed * kPeriod / kRound;
  // At the slowest speeds a round takes a second or two; a few are enough there.
  const int frames = static_cast<int>(rounds * 2.0 * std::numbers::pi / turn);
  double sum = 0.0;
  Vec3 last = Vec3::Zero();
  for (int n = 0; n < frames; ++n) {
    const Pose pose = bench.at(kRound * std::cos(n * turn), kRound * std::sin(n * turn), depth);
    const contact::StageResult r = contact.render(pose);
    coupling::CouplingInput in;
    in.contact.force = r.contact.wrench.force;  // translation only: the ball does not rotate
    in.contact_stiffness_n_per_m = r.contact.stiffness_bound_n_per_m,
    in.contact_stiffness = r.contact.stiffness;
    in.tool = pose;
    const coupling::CouplingOutput command = coupling.step(in, kPeriod);
    out.lowest_j = std::min(out.lowest_j, command.energy_j);
    out.largest_n = std::max(out.largest_n, in.contact.force.norm());
    sum += in.contact.force.norm();
    if (n > 0) {
      const double displacement = (pose.position - last).norm();
      out.path_m += displacement, out.longest_m = std::max(out.longest_m, displacement);
    }
    last = pose.position;
  }
  out.mean_n = sum / frames;
  return out;
}

TEST(F2SlidingOverVoxelBorders, EnergyStaysBoundedFrom1CmTo3MPerS) {
  double least = 0.0;
  for (const double tilt : {0.0, 10.0}) {
    const Bench bench(5.0, tilt);
    for (const contact::ContactModelKind model : kModels)
      for (const double depth : {0.5, 1.5})
        for (const double speed : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0}) {
          const int rounds = speed < 0.05 ? 3 : 20;
          const Slid alone = slide(bench, model, depth, speed, rounds);
          const double period_j = alone.largest_n * alone.longest_m, s = most_ratio(model, 5.0);
          const double voxel_j =
              alone.largest_n * bench.edge_m();  // given and taken back within one
          EXPECT_GE(alone.lowest_j, -5.0 * period_j - voxel_j - s * alone.mean_n * alone.path_m)
              << contact::name_of(model) << " depth " << depth << " tilt " << tilt << " at "
              << speed << " m/s";
          least = std::min(least, alone.lowest_j / (alone.mean_n * alone.path_m));
        }
  }
  std::printf("most debt: %.4f F L\n", -least);
}

/// A ball of five voxels and a ground with an axis along z, touched from outside or from within at
/// `radius_m`; behind a spring of 300 N/m as for a stylus.
struct Round {
  static constexpr double kEdge = 2e-3, kBall = 0.01, kPeriod = 1e-3, kStep = 5e-5;
  Round(const mesh::TriangleMesh& mesh, double radius_m, contact::ContactModelKind model)
      : radius(radius_m),
        ground(mesh, kEdge),
        contact(ground.renderer(test::exact_shell(ball.mesh, kEdge), model)),
        coupling(spec(), {.max_force_n = 1e4, .max_torque_nm = 1e3}, kPeriod, 0.0) {
    series.set_target({1.0 / 300.0, 0.0});
  }
  static coupling::CouplingSpec spec() {
    coupling::CouplingSpec s;
    s.kind = "direct", s.stiffness_cap_n_per_m = 300.0;
    return s;
  }
  /// To the given angle and depth, in small steps; the displayed force does its work on each.
  void go(double to_angle, double to_depth) {
    const double displacement = std::hypot(radius * (to_angle - angle), to_depth - depth);
    const int steps = std::max(1, static_cast<int>(std::ceil(displacement / kStep)));
    const double from_angle = angle, from_depth = depth;
    for (int n = 1; n <= steps; ++n) {
      angle = from_angle + (to_angle - from_angle) * n / steps,
      depth = from_depth + (to_depth - from_depth) * n / steps;
      const double r = radius > 0.03 ? radius - kBall + depth
                                     : radius + kBall - depth;  // the larger one is a hollow
      const Pose pose =
          ball.posed(Vec3(r * std::cos(angle), r * std::sin(angle), 0.4e-3), Quat::Identity());
      contact::StageResult result;
      series.begin(pose, kPeriod);
      do {
        result = contact.render(series.tool()), ++lookups;
      } while (series.settle(
          {{result.contact.wrench.force, Vec3::Zero()}, translation_of(result.contact.stiffness)}));
      ++frames;
      if (known)
        energy_generated_j += force.dot(pose.position - last),
            path_n_m += force.norm() * (pose.position - last).norm();
      coupling::CouplingInput in;
      in.contact.force = series.wrench().force;
      in.contact_stiffness =
          rendering::in_series(translation_of(result.contact.stiffness), series.compliance());
      in.contact_stiffness_n_per_m = 300.0, in.tool = pose;
      const coupling::CouplingOutput out = coupling.step(in, kPeriod);
      lowest_j = std::min(lowest_j, out.energy_j);
      force = out.wrench.force, last = pose.position, known = true;
      most_n = std::max(most_n, force.norm());
    }
  }
  static Mat6 translation_of(const Mat6& stiffness) {
    Mat6 out = Mat6::Zero();
    out.topLeftCorner<3, 3>() = stiffness.topLeftCorner<3, 3>();
    return out;
  }
  double radius;
  rendering::SeriesSpring series;
  double lookups = 0.0, frames = 0.0;
  test::Ball ball{kBall, 3};
  test::Ground ground;
  contact::ContactRenderer contact;
  coupling::RunningCoupling coupling;
  double angle = 0.1, depth = -1e-3, energy_generated_j = 0.0, path_n_m = 0.0, lowest_j = 0.0,
         most_n = 0.0;
  Vec3 force = Vec3::Zero(), last = Vec3::Zero();
  bool known = false;
};

/// Moved in, slid and pulled out, and in loops that never leave the contact, the hand gets at most
/// the energy of sliding over voxels.
TEST(F2SlidingOverVoxelBorders, LatchedForceAddsNoEnergy) {
  mesh::TriangleMesh hollow = test::joined(test::cylinder_mesh(0.05, 0.08, 192),
                                           test::inside_out(test::cylinder_mesh(0.04, 0.06, 192)));
  double most = 0.0;
  for (const bool within : {false, true})
    for (const contact::ContactModelKind model : kModels)
      for (const double deep : {2e-3, 6e-3})
        for (const bool leaves : {true, false}) {
          Round round(within ? hollow : test::cylinder_mesh(0.02, 0.06, 192), within ? 0.04 : 0.02,
                      model);
          const double slide = 0.01 / round.radius, between = leaves ? -1e-3 : 0.5 * deep;
          for (int n = 0; n < 10; ++n) {
            round.go(0.1, deep);
            round.go(0.1 + slide, deep);
            round.go(0.1 + slide, between);
            round.go(0.1, between);
          }
          round.go(0.1, -1e-3);
          const double fraction = round.energy_generated_j / round.path_n_m;
          std::printf(
              "%s %s, %g mm deep, %s: up to %.3f N, given %+.2e J, %+.4f of force times way, "
              "observer's lowest %+.2e J\n",
              within ? "hollow" : "cylinder", std::string(contact::name_of(model)).c_str(),
              1e3 * deep, leaves ? "pulled out" : "never out", round.most_n,
              round.energy_generated_j, fraction, round.lowest_j);
          EXPECT_LE(fraction, kSlidingRatio / 4.0) << contact::name_of(model);
          EXPECT_GE(round.lowest_j, -5.0 * round.most_n * Round::kStep -
                                        round.most_n * Round::kEdge -
                                        kSlidingRatio / 5.0 * round.path_n_m);
          most = std::max(most, fraction);
        }
  std::printf("most given over force times way %.4f\n", most);
}

}  // namespace
}  // namespace voxtouch::sliding
