// Sliding over voxel borders gives energy; how much at most, and what the observer of the coupling makes of it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "core/coupling/passivity.hpp"
#include "core/coupling/running_coupling.hpp"
#include "tests/experiments/stability_map/sliding_loop.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::sliding {
namespace {

constexpr std::array kModels = {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted, contact::ContactModelKind::kField};

/// The bound that the map shows (deploy/pictures/stability_map.png): energy given on a closed loop, over mean force times way, for a
/// ball of `radius_voxels`. core/coupling/passivity.hpp states the same.
double most_share(contact::ContactModelKind model, double radius_voxels) {
  switch (model) {
    case contact::ContactModelKind::kOriginal:
    case contact::ContactModelKind::kAdapted: return coupling::kSlidingShare / radius_voxels;
    case contact::ContactModelKind::kField: return radius_voxels < 5.0 ? 0.4 * coupling::kSlidingShare / radius_voxels : 1e-6;
  }
  return 0.0;
}

TEST(F2SlidingOverVoxelBorders, GivesNoMoreEnergyOnAClosedLoopThanTheMapStates) {
  const std::uint64_t seed = voxtouch::testing::seed(7);
  SCOPED_TRACE(voxtouch::testing::seed_trace(seed));
  for (const double radius : {2.5, 5.0, 10.0})
    for (const double tilt : {0.0, 2.0, 15.0, 45.0}) {
      const Bench bench(radius, tilt);
      for (const contact::ContactModelKind model : kModels)
        for (const double depth : {0.25, 0.5, 1.5}) {
          const Created made = bench.worst_loop(model, depth, 1, seed);
          EXPECT_LE(made.share, most_share(model, radius))
              << contact::name_of(model) << " R/e " << radius << " depth " << depth << " tilt " << tilt;
          // The row's own bound: k e^2 for each point and crossing.
          EXPECT_LE(made.per_crossing, 0.01)
              << contact::name_of(model) << " R/e " << radius << " depth " << depth << " tilt " << tilt;
        }
    }
}

struct Slid {
  double lowest_j = 0.0;  ///< translation, of the observer
  double largest_n = 0.0, way_m = 0.0, longest_m = 0.0, mean_n = 0.0;
};

/// A hand that nothing moves slides round and round at `speed`, 1 kHz; the commands are what the observer books.
Slid slide(const Bench& bench, contact::ContactModelKind model, double depth_voxels, double speed, int rounds,
           double most_damping) {
  constexpr double kPeriod = 1e-3, kRound = 3e-3;
  contact::ContactRenderer contact = bench.renderer(model);
  coupling::CouplingSpec spec;
  spec.kind = "direct";
  spec.velocity_filter_hz = 100.0;
  spec.passivity_damping_limit_ns_per_m = most_damping;
  coupling::RunningCoupling coupling(spec, {.max_force_n = 1e4, .max_torque_nm = 1e3}, kPeriod, 1e-3, {1e3, 1e3});
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
    in.contact.force = r.contact.wrench.force;  // of translation alone: a ball that does not turn
    in.contact_stiffness_n_per_m = r.contact.stiffness_bound_n_per_m, in.contact_stiffness = r.contact.stiffness;
    in.tool = pose;
    const coupling::CouplingOutput command = coupling.step(in, kPeriod);
    out.lowest_j = std::min(out.lowest_j, command.energy_j);
    out.largest_n = std::max(out.largest_n, in.contact.force.norm());
    sum += in.contact.force.norm();
    if (n > 0) {
      const double way = (pose.position - last).norm();
      out.way_m += way, out.longest_m = std::max(out.longest_m, way);
    }
    last = pose.position;
  }
  out.mean_n = sum / frames;
  return out;
}

TEST(F2SlidingOverVoxelBorders, StaysWithinWhatTheObserverIsPromisedFromACentimetreToThreeMetresASecond) {
  double worst = 0.0, least = 0.0;
  for (const double tilt : {0.0, 10.0}) {
    const Bench bench(5.0, tilt);
    for (const contact::ContactModelKind model : kModels)
      for (const double depth : {0.5, 1.5})
        for (const double speed : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0}) {
          const int rounds = speed < 0.05 ? 3 : 20;
          const Slid alone = slide(bench, model, depth, speed, rounds, 0.0);
          const double period_j = alone.largest_n * alone.longest_m, s = most_share(model, 5.0);
          const double voxel_j = alone.largest_n * bench.edge_m();  // given and taken back within one
          EXPECT_GE(alone.lowest_j, -5.0 * period_j - voxel_j - s * alone.mean_n * alone.way_m)
              << contact::name_of(model) << " depth " << depth << " tilt " << tilt << " at " << speed << " m/s";
          // With the controller: where its damping takes more than sliding gives, twenty rounds cost no more than one.
          const double damping = 4.0 * std::max(s, 0.5e-3) * alone.largest_n / speed;
          const Slid braked = slide(bench, model, depth, speed, rounds, damping);
          EXPECT_GE(braked.lowest_j, -5.0 * period_j - voxel_j)
              << contact::name_of(model) << " depth " << depth << " tilt " << tilt << " at " << speed << " m/s, " << damping
              << " Ns/m";
          worst = std::max(worst, (-braked.lowest_j - 5.0 * period_j) / voxel_j);
          least = std::min(least, alone.lowest_j / (alone.mean_n * alone.way_m));
        }
  }
  std::printf("most debt beyond five periods with the controller: %.2f F e; only observed: %.4f F L\n", worst, -least);
}

}  // namespace
}  // namespace voxtouch::sliding
