// The check at start on devices that match their file, and on others.
#include "core/identification/start_check.hpp"

#include <gtest/gtest.h>

#include "tests/support/heap_count/heap_count.hpp"
#include "tests/support/identification/population.hpp"
#include "tests/support/identification/started_device.hpp"
#include "tests/support/seed.hpp"

namespace voxtouch::identification {
namespace {

using testing::check_start;
using testing::Holding;
using testing::Planted;

/// An arm with a fine encoder that a hand holds still: every figure is measured.
std::array<testing::AxisTruth, 3> fine_device() {
  const testing::AxisTruth axis{.mass_kg = 5.0,
                                .viscous_ns_per_m = 2.0,
                                .coulomb_n = 0.2,
                                .delay_s = 2e-3,
                                .encoder_step_m = 1e-6,
                                .max_force_n = 100.0};
  return {axis, axis, axis};
}

TEST(StartCheck, ADeviceAgreesWithItsFile) {
  const auto found = check_start(fine_device(), Planted::kHealthy, Holding::kStill, 3).findings;
  EXPECT_EQ(found.mass_kg.finding, Finding::kAgrees);
  EXPECT_EQ(found.delay_s.finding, Finding::kAgrees);
  EXPECT_EQ(found.encoder_step_m.finding, Finding::kAgrees);
}

TEST(StartCheck, TwiceTheDelayDiffersAndNothingElse) {
  const auto found = check_start(fine_device(), Planted::kDelayTwice, Holding::kStill, 3).findings;
  EXPECT_EQ(found.delay_s.finding, Finding::kDiffers);
  EXPECT_LE(found.delay_s.low, 4.1e-3);
  EXPECT_GE(found.delay_s.high, 3.9e-3);
  EXPECT_NE(found.mass_kg.finding, Finding::kDiffers);
  EXPECT_EQ(found.encoder_step_m.finding, Finding::kAgrees);
}

TEST(StartCheck, TwiceTheMassDiffers) {
  auto truth = fine_device();
  for (testing::AxisTruth& axis : truth)
    axis.mass_kg = 10.0;  // more than the check's allowance for a hand
  const auto found = check_start(truth, Planted::kMassTwice, Holding::kReleased, 3).findings;
  EXPECT_EQ(found.mass_kg.finding, Finding::kDiffers);
  EXPECT_NEAR(0.5 * (found.mass_kg.low + found.mass_kg.high), 20.0, 2.0);
}

TEST(StartCheck, FourfoldEncoderStepsDiffer) {
  const auto found =
      check_start(fine_device(), Planted::kEncoderFourfold, Holding::kStill, 3).findings;
  EXPECT_EQ(found.encoder_step_m.finding, Finding::kDiffers);
  EXPECT_NEAR(found.encoder_step_m.low, 4e-6, 1e-9);
}

TEST(StartCheck, RaisesNoFalseAlarmOnHealthyDevices) {
  const std::uint64_t chosen = testing::seed(21);
  SCOPED_TRACE(testing::seed_trace(chosen));
  std::mt19937_64 random(chosen);
  int alarms = 0;
  for (int i = 0; i < 200; ++i) {
    const auto truth = testing::random_device(random, testing::Family::kRigid);
    const auto holding = static_cast<Holding>(i % 3);
    alarms += check_start(truth, Planted::kHealthy, holding, random()).findings.differs();
  }
  EXPECT_LE(alarms, 2);
}

TEST(StartCheck, TonesStayBelowATenthOfAMetrePerSecondSquared) {
  EXPECT_LT(check_start(fine_device(), Planted::kHealthy, Holding::kStill, 3).acceleration, 0.1);
}

TEST(StartCheck, AStuckDeviceIsNotMeasured) {
  auto truth = fine_device();
  for (testing::AxisTruth& axis : truth)
    axis.coulomb_n = 20.0;
  const auto found = check_start(truth, Planted::kMassHalf, Holding::kReleased, 3).findings;
  EXPECT_EQ(found.mass_kg.finding, Finding::kNotMeasured);
  EXPECT_FALSE(found.differs());
}

TEST(StartCheck, AClockThatStandsStillNeverFinishesAndGivesNoForce) {
  StartCheck check;
  check.start(testing::file_of(fine_device()));
  check.force(0.0, Vec3::Zero());
  for (int i = 0; i < 5000; ++i) {
    const Vec3 first = check.force(1.0, Vec3::Zero()), second = check.force(1.0, Vec3::Zero());
    EXPECT_TRUE(first == Vec3::Zero() || second == Vec3::Zero());
  }
  EXPECT_FALSE(check.finished());
}

TEST(StartCheck, ForceAndAppliedAllocateNothing) {
  StartCheck check;
  check.start(testing::file_of(fine_device()));
  long allocations = 0;
  for (int i = 0; !check.finished(); ++i)
    allocations += test::heap_count_of([&] {
      check.applied(check.force(1e-3 * i, {1e-6 * i, 0.0, 0.0}));
    });
  EXPECT_EQ(allocations, 0);
}

}  // namespace
}  // namespace voxtouch::identification
