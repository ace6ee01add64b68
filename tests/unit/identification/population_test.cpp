// A small population; tests/experiments/identification runs it in full size.
#include "tests/support/identification/population.hpp"

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace voxtouch::testing {
namespace {

Counts population(Family family, int devices, double mass_limit, std::uint64_t chosen) {
  std::mt19937_64 random(chosen);
  Counts counts;
  for (int i = 0; i < devices; ++i) {
    const auto truth = random_device(random, family);
    counts.add(identify_axis(truth[0], random()), mass_limit);
  }
  return counts;
}

TEST(Identification, MeasuresRandomDevices) {
  const std::uint64_t chosen = seed(5);
  SCOPED_TRACE(seed_trace(chosen));
  const Counts c = population(Family::kRigid, 12, 0.02, chosen);
  SCOPED_TRACE(to_text(c));
  EXPECT_GE(c.measured, 11);
  EXPECT_GE(c.mass, c.measured - 1);
  EXPECT_GE(c.viscous, c.measured - 1);
  EXPECT_GE(c.coulomb, c.measured - 1);
  EXPECT_GE(c.step, c.measured);
  EXPECT_GE(c.delay, c.reserve - 2);
  for (const int covered : c.covered)
    EXPECT_GE(covered, c.measured - 2);
}

TEST(Identification, MassSurvivesStribeckFriction) {
  const std::uint64_t chosen = seed(6);
  SCOPED_TRACE(seed_trace(chosen));
  const Counts c = population(Family::kStribeck, 5, 0.05, chosen);
  SCOPED_TRACE(to_text(c));
  EXPECT_GE(c.mass, c.measured - 1);
}

TEST(Identification, TooMuchFrictionGivesABoundAndNoFigures) {
  const AxisTruth truth{.mass_kg = 0.3, .coulomb_n = 1.8, .max_force_n = 10.0};
  const AxisRun run = identify_axis(truth, 3);
  EXPECT_EQ(run.figures.outcome, identification::Outcome::kFrictionTooHigh);
  EXPECT_NEAR(run.figures.break_away_n, 1.8, 0.15);
}

}  // namespace
}  // namespace voxtouch::testing
