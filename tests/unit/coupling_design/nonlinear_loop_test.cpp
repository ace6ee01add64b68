#include "tests/support/coupling_models/nonlinear_loop.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/support/coupling_models/loop_law.hpp"

namespace voxtouch::coupling::design {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Row {
  coupling_models::NonlinearLoop loop;
  double radius, critical, frequency;
  std::string note;
};

std::vector<Row> rows() {
  std::ifstream file(std::string(VOXTOUCH_TEST_DATA) + "/vectors/loop_cases.json");
  std::vector<Row> out;
  const auto document = nlohmann::json::parse(file);
  for (const auto& c : document.at("cases")) {
    Row row;
    const auto number = [&](const char* key) { return c.at(key).get<double>(); };
    row.loop.plant = {number("m"),   number("b"), number("m_h"),   number("b_h"),
                      number("k_h"), number("T"), number("delay"), number("force_lag")};
    LoopController& k = row.loop.controller;
    k.w0_rad_per_s = number("w0"), k.damping_ratio = number("d"), k.gain = number("K");
    k.injected_damping = number("B_inj"), k.velocity_filter_rad_per_s = number("w_v");
    row.loop.contact_stiffness = number("k");
    row.loop.wall = coupling_models::WallLaw::kBilateral;
    row.loop.start_speed = 1e-15;  // linear, so any scale works; a growth by exp(32) stays finite
    row.radius = number("spectral_radius"), row.critical = number("k_crit"),
    row.frequency = number("omega_crit");
    row.note = c.at("note").get<std::string>();
    out.push_back(row);
  }
  return out;
}

/// Runs for 4 quarters of `samples` each, exactly.
coupling_models::NonlinearVerdict run_quarters(coupling_models::NonlinearLoop loop,
                                               double samples) {
  loop.duration_s = loop.longest_s = 4.0 * samples * loop.plant.period_s;
  return coupling_models::simulate(loop);
}

TEST(NonlinearLoop, GrowsAndDecaysByItsEigenvalues) {
  int compared = 0;
  for (const Row& row : rows()) {
    const double rate = std::log(row.radius);
    // Long enough for the other eigenvalues to fade; the slowest rows have them far away.
    const double samples = std::ceil((std::abs(rate) > 1e-4 ? 8.0 : 1.5) / std::abs(rate));
    const coupling_models::NonlinearVerdict v = run_quarters(row.loop, samples);
    const double measured = std::log(v.late_amplitude / v.early_amplitude) / samples;
    // A quarter may begin anywhere in a swing, which is worth the growth of up to half a swing.
    const double half_swing = kPi / (row.frequency * row.loop.plant.period_s);
    EXPECT_NEAR(measured / rate, 1.0, 0.002 + half_swing / samples)
        << row.note << ", k " << row.loop.contact_stiffness;
    ++compared;
  }
  EXPECT_EQ(compared, 20);
}

TEST(NonlinearLoop, BecomesUnstableAtTheCriticalStiffness) {
  std::map<double, Row> loops;  // one per loop: rows that differ only in k use the same
  for (const Row& row : rows())
    loops[row.critical] = row;
  for (auto& [critical, row] : loops) {
    if (critical < 2.0)
      continue;  // a released Phantom at 5 Hz changes by 1e-7 a sample there
    for (const double factor : {0.98, 1.02}) {
      row.loop.contact_stiffness = factor * critical;
      const coupling_models::NonlinearVerdict v = run_quarters(row.loop, 50'000);
      const bool grows = v.outcome == coupling_models::LoopOutcome::kRunaway ||
                         v.late_amplitude > v.early_amplitude;
      EXPECT_EQ(grows, factor > 1.0) << row.note << " at " << factor << " of " << critical;
    }
  }
}

TEST(NonlinearLoop, SpringDamperActsAsTwoSpringsInSeries) {
  coupling_models::NonlinearLoop loop;
  loop.plant = {0.1, 5.0, 0, 0, 0, 1e-3, 0, 0};
  loop.controller.law = LoopController::Law::kSpringDamper;
  loop.controller.stiffness = 300.0, loop.controller.damping = 1.0;
  loop.contact_stiffness = 600.0;
  loop.push = 1.0;
  for (const coupling_models::WallLaw wall :
       {coupling_models::WallLaw::kBilateral, coupling_models::WallLaw::kUnilateral}) {
    loop.wall = wall;
    const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
    EXPECT_TRUE(v.stable);
    EXPECT_NEAR(v.end_position, 1.0 / 200.0, 1e-6);
  }
}

/// The paper's recipe on a robot of 5 kg and 30 Ns/m before a wall of 2000 N/m.
coupling_models::NonlinearLoop literal_recipe() {
  coupling_models::NonlinearLoop loop;
  loop.plant = {5.0, 30.0, 0.0, 0.0, 0.0, 1e-3, 2e-3, 3e-3};
  loop.controller.w0_rad_per_s = 10.0 * kPi, loop.controller.damping_ratio = 1.0;
  loop.contact_stiffness = 2000.0;
  loop.resolution = 1e-5;
  loop.push = 3.6, loop.start_speed = 0.02;
  loop.duration_s = 20.0;
  return loop;
}

TEST(NonlinearLoop, RecipeOscillatesWithoutFriction) {
  const coupling_models::NonlinearVerdict v = coupling_models::simulate(literal_recipe());
  EXPECT_FALSE(v.stable);
  EXPECT_NEAR(v.late_amplitude, 0.048, 0.003);
  EXPECT_GT(v.energy_extracted_j, 0.1);
}

TEST(NonlinearLoop, ThreeNewtonsOfFrictionQuietTheRecipe) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.coulomb_friction = 3.0;
  const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
  EXPECT_TRUE(v.stable);
  EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest);
  EXPECT_LE(v.late_amplitude, loop.resolution);
}

TEST(NonlinearLoop, DistinguishesSlowDecayFromOscillation) {
  coupling_models::NonlinearLoop
      loop;  // a bilateral wall at 0.9 of the limit, first evaluated for too short a time
  loop.plant = {0.1, 0.05, 0, 0, 0, 1e-3, 1e-3, 0};
  loop.controller.w0_rad_per_s = 10.0 * kPi, loop.controller.damping_ratio = 0.707;
  loop.wall = coupling_models::WallLaw::kUnilateral;
  loop.push = 0.01, loop.start_speed = 0.01;
  loop.longest_s = 1280.0;
  for (const double duration : {10.0, 20.0, 40.0, 80.0, 160.0}) {
    loop.duration_s = duration;
    loop.contact_stiffness = 0.9 * 1.07556384;
    EXPECT_TRUE(coupling_models::simulate(loop).stable) << duration;
    loop.contact_stiffness = 1.1 * 1.07556384;
    EXPECT_FALSE(coupling_models::simulate(loop).stable) << duration;
  }
}

TEST(NonlinearLoop, ContinuesUntilASlowDecayRests) {
  coupling_models::NonlinearLoop loop;
  loop.plant = {0.1, 0.05, 0, 0, 0, 1e-3, 1e-3, 0};
  loop.controller.w0_rad_per_s = 10.0 * kPi, loop.controller.damping_ratio = 0.707;
  loop.push = 0.01, loop.start_speed = 0.01;
  loop.contact_stiffness = 0.5 * 1.07556384;
  loop.duration_s = 5.0, loop.longest_s = 1280.0;
  const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
  EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRest);
  EXPECT_GT(v.simulated_s, 30.0);
  EXPECT_LT(v.simulated_s, 400.0);
}

TEST(NonlinearLoop, ClassifiesAJitteredLimitCycle) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.jitter = 0.2, loop.loss = 0.03, loop.delay_jitter_s = 1e-3;
  for (loop.seed = 0; loop.seed < 20; ++loop.seed) {
    const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
    EXPECT_FALSE(v.stable);
    EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kSustained);
  }
}

TEST(NonlinearLoop, DivergesAtATooStiffBilateralWall) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.wall = coupling_models::WallLaw::kBilateral;
  const coupling_models::NonlinearVerdict v = coupling_models::simulate(loop);
  EXPECT_EQ(v.outcome, coupling_models::LoopOutcome::kRunaway);
  EXPECT_FALSE(v.stable);
}

TEST(NonlinearLoop, AppliesTheRequestedJitterLossAndDelay) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.jitter = 0.2, loop.loss = 0.05, loop.most_consecutive_losses = 2,
  loop.delay_jitter_s = 2.5e-3;
  loop.duration_s = loop.longest_s = 400.0;
  const coupling_models::LoopStatistics s = coupling_models::simulate(loop).statistics;
  EXPECT_EQ(s.samples, 400'000u);
  EXPECT_NEAR(s.period_mean, 1e-3, 2e-6);
  EXPECT_NEAR(s.period_min, 0.8e-3, 1e-8);
  EXPECT_NEAR(s.period_max, 1.2e-3, 1e-8);
  EXPECT_NEAR(static_cast<double>(s.lost) / static_cast<double>(s.samples),
              0.05 * (1 - 0.05 * 0.05), 0.0015);
  EXPECT_EQ(s.longest_loss, 2u);
  EXPECT_NEAR(s.delay_min, 2e-3, 1e-7);
  EXPECT_NEAR(s.delay_max, 4.5e-3, 1e-7);
  EXPECT_GT(s.overtaken,
            1000u);  // a delay jitter beyond the period makes newer efforts arrive first
}

TEST(NonlinearLoop, IsPunctualWithoutJitter) {
  const coupling_models::LoopStatistics s = coupling_models::simulate(literal_recipe()).statistics;
  EXPECT_EQ(s.lost, 0u);
  EXPECT_EQ(s.overtaken, 0u);
  EXPECT_EQ(s.period_min, 1e-3);
  EXPECT_EQ(s.period_max, 1e-3);
}

TEST(NonlinearLoop, SameSeedIsBitIdentical) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.jitter = 0.2, loop.loss = 0.02, loop.delay_jitter_s = 1e-3, loop.coulomb_friction = 0.2,
  loop.seed = 9;
  const coupling_models::NonlinearVerdict a = coupling_models::simulate(loop),
                                          b = coupling_models::simulate(loop);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a.late_amplitude),
            std::bit_cast<std::uint64_t>(b.late_amplitude));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a.energy_extracted_j),
            std::bit_cast<std::uint64_t>(b.energy_extracted_j));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a.end_position),
            std::bit_cast<std::uint64_t>(b.end_position));
  loop.seed = 10;
  EXPECT_NE(coupling_models::simulate(loop).energy_extracted_j, a.energy_extracted_j);
}

TEST(NonlinearLoop, WallsAreMonotoneUpToTheStiffness) {
  const double k = 500.0, knee = 1e-3, step = 1e-5;
  for (const coupling_models::WallLaw law :
       {coupling_models::WallLaw::kUnilateral, coupling_models::WallLaw::kSoftening,
        coupling_models::WallLaw::kHardening}) {
    double steepest = 0.0;
    for (int i = -300; i < 300; ++i) {
      const double here = coupling_models::wall_effort(law, k, knee, step * i),
                   slope =
                       (coupling_models::wall_effort(law, k, knee, step * (i + 1)) - here) / step;
      EXPECT_GE(here, 0.0);
      EXPECT_GE(slope, i < 0 ? 0.0 : 0.299 * k);
      if (i < 0) {
        EXPECT_EQ(here, 0.0);
      }
      steepest = std::max(steepest, slope);
    }
    EXPECT_NEAR(steepest, k, 1e-6 * k);
  }
  EXPECT_NEAR(coupling_models::wall_effort(coupling_models::WallLaw::kSoftening, k, knee, 3e-3),
              k * 1.6e-3, 1e-12);
  EXPECT_NEAR(coupling_models::wall_effort(coupling_models::WallLaw::kHardening, k, knee, 3e-3),
              k * 2.3e-3, 1e-12);
  EXPECT_EQ(coupling_models::wall_effort(coupling_models::WallLaw::kBilateral, k, knee, -2e-3),
            -1.0);
}

TEST(NonlinearLoop, DampingInContactNeverPulls) {
  coupling_models::NonlinearLoop loop;
  loop.plant = {0.1, 0.05, 0, 0, 0, 1e-3, 1e-3, 0};
  loop.controller.w0_rad_per_s = 2.0 * kPi * 60.0, loop.controller.damping_ratio = 0.707;
  loop.controller.injected_damping = 5.0, loop.controller.velocity_filter_rad_per_s = 628.0;
  loop.contact_stiffness = 200.0;
  loop.start_position = 0.005,
  loop.start_speed = -0.5;  // torn out of the wall: the damping would hold it back
  loop.duration_s = loop.longest_s = 0.2;
  const coupling_models::NonlinearVerdict pulled = coupling_models::simulate(loop);
  loop.damping_only_in_contact = true;
  const coupling_models::NonlinearVerdict released = coupling_models::simulate(loop);
  EXPECT_LT(released.end_position, pulled.end_position - 1e-3);
  EXPECT_LE(released.energy_extracted_j, 0.5 * 200.0 * 0.005 * 0.005 * 1.01);
}

TEST(NonlinearLoop, NeverPullsAtAnySpeed) {
  coupling_models::NonlinearLoop loop;
  loop.plant.period_s = 1e-3;
  loop.controller.w0_rad_per_s = 2.0 * kPi * 60.0,
  loop.controller.damping_ratio = 1.0;  // below 1 the filter itself swings over
  loop.controller.injected_damping = 5.0, loop.controller.velocity_filter_rad_per_s = 628.0;
  loop.damping_only_in_contact = true;
  coupling_models::LoopLaw law(loop);
  double strongest = 0.0;
  for (int i = 0; i < 100; ++i)
    strongest = std::min(strongest, law.step(0.01 * i / 100.0, 200.0, 1e-3));
  EXPECT_LT(strongest, -1.0);
  for (int i = 0; i < 100; ++i)
    EXPECT_LE(law.step(0.01 - 0.0005 * i, 200.0, 1e-3), 0.0) << i;
}

/// A design with a margin of 2 in its worst case, for an unbounded damper. A damper limited to half
/// of the law's force is weaker in a large oscillation than the certified one: the device keeps
/// bouncing. A design is therefore certified for the bounded damper.
TEST(NonlinearLoop, BoundedDamperNeedsItsOwnCertificate) {
  coupling_models::NonlinearLoop loop;
  loop.plant = {.mass = 0.114234103822958,
                .damping = 0.17277056763042722,
                .period_s = 0.00055210490979943521,
                .delay_s = 0.00082707454482308076,
                .effort_lag_s = 0.0030998013752803412};
  loop.controller = {.w0_rad_per_s = 125.66370614359172,
                     .damping_ratio = 1.0,
                     .gain = 0.58673166044757141,
                     .injected_damping = 16.338800378759132,
                     .velocity_filter_rad_per_s = 1256.6370614359173};
  loop.contact_stiffness = 1249.842062665216, loop.wall = coupling_models::WallLaw::kHardening,
  loop.wall_knee = 0.001867933149760688;
  loop.resolution = 1.7558561949049544e-06;
  loop.damping_only_in_contact = true, loop.push = 2.985384978940393,
  loop.start_speed = 0.092972250067355822;
  loop.jitter = 0.2, loop.measured_period = true, loop.delay_jitter_s = 0.00011042098195988705;
  loop.loss = 0.026423134074208952, loop.most_consecutive_losses = 3;
  loop.duration_s = 10.579033722208118, loop.longest_s = 84.632269777664945,
  loop.seed = 10502131564318940975U;
  EXPECT_TRUE(coupling_models::simulate(loop).stable);
  loop.damping_fraction = 0.5;
  EXPECT_FALSE(coupling_models::simulate(loop).stable);
}

/// A stylus of 45 g as designed, on the velocity of a window: with the encoder, uneven periods and
/// lost samples, in every corner of the hands.
TEST(NonlinearLoop, AStylusOnTheVelocityOfAWindowIsStable) {
  coupling_models::NonlinearLoop loop;
  loop.controller = {
      .law = LoopController::Law::kDirect, .injected_damping = 3.43, .velocity_window = 4};
  const double displayed = 684.0;
  double most = 0.0;
  int runs = 0;
  for (const double mass : {0.0, 0.02, 0.2})
    for (const double damping : {0.5, 8.0})
      for (const double stiffness : {20.0, 800.0})
        for (const int lost : {0, 1}) {
          loop.plant = {.mass = 0.045, .damping = 0.005, .delay_s = 1e-3};
          if (mass > 0.0)
            loop.plant.hand_mass = mass, loop.plant.hand_damping = damping,
            loop.plant.hand_stiffness = stiffness;
          loop.contact_stiffness = displayed, loop.wall = coupling_models::WallLaw::kUnilateral;
          loop.resolution = 3e-5, loop.jitter = 0.2, loop.loss = 0.03,
          loop.most_consecutive_losses = lost;
          loop.damping_only_in_contact = runs % 3 > 0, loop.measured_period = runs % 2 > 0;
          loop.push = 0.3, loop.start_speed = 0.2, loop.duration_s = 4.0,
          loop.seed = 40U + static_cast<unsigned>(++runs);
          const coupling_models::NonlinearVerdict verdict = coupling_models::simulate(loop);
          EXPECT_TRUE(verdict.stable) << mass << " " << damping << " " << stiffness << " " << lost
                                      << ": " << verdict.late_amplitude;
          most = std::max(most, verdict.late_effort);
          loop.contact_stiffness = 1.9 * displayed, loop.jitter = loop.loss = 0.0,
          loop.measured_period = false;
          EXPECT_TRUE(coupling_models::simulate(loop).stable)
              << mass << " " << damping << " " << stiffness << " at 1.9 times";
        }
  std::printf("%d runs, command at rest at most %.3f N peak to peak\n", runs, most);
}

TEST(NonlinearLoop, FindsTheLimitOfALoopOnTheVelocityOfAWindow) {
  for (int window = 1; window <= kMaxVelocityWindow; ++window) {
    coupling_models::NonlinearLoop loop;
    loop.plant = {.mass = 0.08, .damping = 0.1, .delay_s = 1e-3};
    loop.controller = {
        .law = LoopController::Law::kDirect, .injected_damping = 2.0, .velocity_window = window};
    loop.wall = coupling_models::WallLaw::kBilateral, loop.start_speed = 1e-3,
    loop.duration_s = 2.0;
    const double limit = critical_stiffness(loop.plant, loop.controller).stiffness;
    EXPECT_NEAR(coupling_models::simulated_limit(loop, 0.5 * limit, 1e5, 0.01), limit, 0.03 * limit)
        << window;
  }
}

TEST(NonlinearLoop, FindsTheLimitThatTheLinearModelHas) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.wall = coupling_models::WallLaw::kBilateral, loop.resolution = 0.0;
  EXPECT_NEAR(coupling_models::simulated_limit(loop, 100.0, 1e5, 0.01), 508.99, 8.0);
}

TEST(NonlinearLoop, RefusesInvalidNumbers) {
  coupling_models::NonlinearLoop loop = literal_recipe();
  loop.jitter = 1.0;
  EXPECT_THROW(coupling_models::simulate(loop), std::invalid_argument);
  loop = literal_recipe(), loop.plant.mass = 0.0;
  EXPECT_THROW(coupling_models::simulate(loop), std::invalid_argument);
  loop = literal_recipe(), loop.plant.delay_s = 1.0;
  EXPECT_THROW(coupling_models::simulate(loop), std::invalid_argument);
  loop = literal_recipe(), loop.plant.damping = NAN;
  EXPECT_THROW(coupling_models::simulate(loop), std::invalid_argument);
}

}  // namespace
}  // namespace voxtouch::coupling::design
