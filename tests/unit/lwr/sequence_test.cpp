#include <gtest/gtest.h>

#include "devices/arm/joint_rates.hpp"
#include "devices/lwr/fri_capture.hpp"
#include "devices/lwr/fri_clock.hpp"
#include "devices/lwr/fri_sequence.hpp"

namespace voxtouch::lwr::fri {
namespace {

using Verdict = SequenceTracker::Verdict;

TEST(FriSequence, TakesEachCountOnceAcrossTheWrap) {
  SequenceTracker tracker;
  for (std::uint16_t n = 65000; n != 1000; ++n) {
    ASSERT_EQ(tracker.update(n), Verdict::kNew);
    ASSERT_EQ(tracker.steps(), 1U);
    ASSERT_EQ(tracker.update(n), Verdict::kDuplicate);
  }
  EXPECT_EQ(tracker.counts().lost, 0U);
  EXPECT_EQ(tracker.counts().duplicates, 1536U);
}

TEST(FriSequence, CountsWhatIsLostAndWhatComesLate) {
  SequenceTracker tracker;
  tracker.update(65534);
  EXPECT_EQ(tracker.update(1), Verdict::kNew);
  EXPECT_EQ(tracker.steps(), 3U);
  EXPECT_EQ(tracker.counts().lost, 2U);
  EXPECT_EQ(tracker.update(65535), Verdict::kOld);
  EXPECT_EQ(tracker.update(0), Verdict::kOld);
  EXPECT_EQ(tracker.counts().reordered, 2U);
  EXPECT_EQ(tracker.update(2), Verdict::kNew);
  EXPECT_EQ(tracker.steps(), 1U);
}

TEST(FriSequence, FollowsARestartedCount) {
  SequenceTracker tracker;
  tracker.update(20000);
  std::uint16_t n = 1;
  while (tracker.update(n) == Verdict::kOld)
    ASSERT_LT(n++, 100);
  EXPECT_EQ(n, SequenceTracker::kRestartRun);
  EXPECT_EQ(tracker.update(static_cast<std::uint16_t>(n + 1)), Verdict::kNew);
  EXPECT_EQ(tracker.counts().restarts, 1U);
}

TEST(FriSequence, DoesNotTakeScatteredOldPacketsForARestart) {
  SequenceTracker tracker;
  tracker.update(20000);
  for (int n = 0; n < 100; ++n)
    EXPECT_EQ(tracker.update(static_cast<std::uint16_t>(19000 + 7 * n % 500)), Verdict::kOld);
}

TEST(FriSequence, AcceptsAnyCountAfterReset) {
  SequenceTracker tracker;
  tracker.update(20000);
  tracker.forget();
  EXPECT_EQ(tracker.update(100), Verdict::kNew);
  EXPECT_EQ(tracker.counts().lost, 0U);
}

TEST(FriClock, CountsPeriodsForCoarseStamps) {
  FriClock clock(1'000'000, false);
  std::int64_t sum = 0;
  for (int n = 0; n < 1000; ++n)
    sum += clock.update(static_cast<float>(9000.0 + 0.001 * n), 1);
  EXPECT_EQ(clock.time_ns(), 999'000'000);
  EXPECT_EQ(sum, clock.time_ns());
  EXPECT_EQ(clock.disagreements(), 0U);
}

TEST(FriClock, KeepsTheCountAgainstAStampThatJumps) {
  FriClock clock(1'000'000, false);
  clock.update(1.000F, 1);
  EXPECT_EQ(clock.update(5.0F, 1), 1'000'000);
  EXPECT_EQ(clock.update(0.0F, 2), 2'000'000);
  EXPECT_EQ(clock.disagreements(), 2U);
}

TEST(FriClock, AcceptsVirtualTime) {
  FriClock clock(1'000'000, true);
  clock.update(1.0F, 1);
  EXPECT_NEAR(static_cast<double>(clock.update(1.004F, 1)), 4e6, 200.0);
  EXPECT_EQ(clock.update(1.005F, 1), 1'000'000) << "where both agree the count has no rounding";
  EXPECT_EQ(clock.update(0.5F, 1), 1'000'000) << "never back";
}

TEST(JointRates, TrailsARampByItsStatedDelay) {
  constexpr double kDt = 1e-3;
  arm::JointRates rates(50.0);
  const LwrJoints acceleration = LwrJoints::Constant(2.0);
  double t = 0.0;
  for (int n = 0; n < 500; ++n, t = n * kDt)
    rates.update(0.5 * t * t * acceleration, kDt);
  const double true_rate = 2.0 * (t - kDt);
  EXPECT_NEAR((true_rate - rates.rate()[3]) / 2.0, 3.68e-3, kDt);
}

TEST(JointRates, RestartsAtRestAfterAGap) {
  arm::JointRates rates(50.0);
  rates.update(LwrJoints::Zero(), 1e-3);
  rates.update(LwrJoints::Constant(0.01), 1e-3);
  EXPECT_GT(rates.rate()[0], 1.0);
  rates.restart();
  EXPECT_EQ(rates.update(LwrJoints::Constant(5.0), 1e-3), LwrJoints::Zero());
}

TEST(FriCapture, KeepsTheNewestAndReportsAWriteFailure) {
  FriCapture capture(3);
  const std::array<std::byte, 10> bytes{};
  for (int n = 0; n < 5; ++n)
    capture.note(bytes, {1, 2}, {3, 4}, n);
  EXPECT_EQ(capture.size(), 3U);
  EXPECT_THROW(capture.write("/nowhere/at/all.pcap"), std::runtime_error);
  FriCapture none;
  none.note(bytes, {1, 2}, {3, 4}, 0);
  EXPECT_EQ(none.size(), 0U);
}

}  // namespace
}  // namespace voxtouch::lwr::fri
