// Quality of the link, schedule of faults, and the line that they act on.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/simulated/link_quality.hpp"
#include "devices/lwr/simulated/session.hpp"

namespace voxtouch::lwr_sim {
namespace {

using lwr::fri::Quality;

void answers(LinkQuality& link, int n) {
  for (int i = 0; i < n; ++i)
    link.answered(1e-4);
}

TEST(LinkQuality, RisesWithARunOfAnswers) {
  LinkQuality link;
  EXPECT_EQ(link.quality(), Quality::kUnacceptable);
  answers(link, 1);
  EXPECT_EQ(link.quality(), Quality::kBad);
  answers(link, 9);
  EXPECT_EQ(link.quality(), Quality::kOk);
  answers(link, 9);
  EXPECT_EQ(link.quality(), Quality::kOk);
  answers(link, 1);
  EXPECT_EQ(link.quality(), Quality::kPerfect);
}

TEST(LinkQuality, FallsThroughMissesAndHasHysteresis) {
  LinkQuality link;
  answers(link, 30);
  link.missed();
  EXPECT_EQ(link.quality(), Quality::kPerfect);
  link.missed();
  EXPECT_EQ(link.quality(), Quality::kOk);
  answers(link, 19);
  EXPECT_EQ(link.quality(), Quality::kOk);  // not up again as easily as down
  answers(link, 1);
  EXPECT_EQ(link.quality(), Quality::kPerfect);
  for (int i = 0; i < 5; ++i)
    link.missed();
  EXPECT_EQ(link.quality(), Quality::kUnacceptable);
}

TEST(LinkQuality, ScatteredMissesAddUpOverAHundred) {
  LinkQuality link;
  answers(link, 30);
  for (int i = 0; i < 10; ++i) {
    link.missed();
    answers(link, 4);
  }
  EXPECT_GE(link.quality(), Quality::kOk);
  link.missed();
  EXPECT_EQ(link.quality(), Quality::kBad);
  answers(link, 20);
  EXPECT_EQ(link.quality(), Quality::kPerfect);  // and they are forgiven
  link.missed();
  EXPECT_EQ(link.quality(), Quality::kPerfect);
}

TEST(LinkQuality, ReportsTheLastHundred) {
  LinkQuality link;
  for (int i = 0; i < 50; ++i)
    link.answered(1e-4), link.answered(3e-4);
  lwr::fri::Statistics s = link.statistics();
  EXPECT_FLOAT_EQ(s.answer_rate, 1.0F);
  EXPECT_NEAR(s.latency_s, 2e-4F, 1e-9F);
  EXPECT_NEAR(s.jitter_s, 2e-4F, 1e-9F);
  for (int i = 0; i < 25; ++i)
    link.missed();
  s = link.statistics();
  EXPECT_FLOAT_EQ(s.miss_rate, 0.25F);
  EXPECT_EQ(s.miss_counter, 25u);
}

TEST(Faults, AreReadFromTheirText) {
  const Fault late = parse_fault("late@2.0:0.1", kFaults);
  EXPECT_EQ(late.kind, FaultKind::kLate);
  EXPECT_EQ(late.start_s, 2.0);
  EXPECT_EQ(late.duration_s, 0.1);
  EXPECT_EQ(late.value, 0.003);
  const Fault loss = parse_fault("loss@0:inf:0.02", kFaults);
  EXPECT_TRUE(std::isinf(loss.duration_s));
  EXPECT_EQ(loss.value, 0.02);
  EXPECT_TRUE(std::isinf(parse_fault("silent@1.5", kFaults).duration_s));
  EXPECT_EQ(parse_fault("nan@1:0.001:3", kFaults).value, 3.0);
}

TEST(Faults, RefuseInvalidTexts) {
  for (const char* text : {"",
                           "late",
                           "late@",
                           "late@x",
                           "late@-1",
                           "late@nan",
                           "late@inf",
                           "lat@1",
                           "late@1:0",
                           "late@1:-1",
                           "late@1:x",
                           "late@1:1:2",
                           "loss@1:1:1.5",
                           "nan@1:1:0",
                           "nan@1:1:9",
                           "nan@1:1:1.5",
                           "late@1:",
                           "quality@1:1:3",
                           "late@1:1:0.1:3",
                           "late@1 ",
                           "reflex@1",
                           "loss late@1"})
    EXPECT_THROW(parse_fault(text, kFaults), std::runtime_error) << text;
}

TEST(Faults, ActFromTheirStartToTheirEnd) {
  const FaultSchedule schedule(
      {parse_fault("late@1:0.5:0.01", kFaults), parse_fault("late@2:0.5:0.02", kFaults)});
  EXPECT_FALSE(schedule.active(FaultKind::kLate, 0.999));
  EXPECT_EQ(schedule.active(FaultKind::kLate, 1.0), 0.01);
  EXPECT_EQ(schedule.active(FaultKind::kLate, 1.499), 0.01);
  EXPECT_FALSE(schedule.active(FaultKind::kLate, 1.5));
  EXPECT_EQ(schedule.active(FaultKind::kLate, 2.2), 0.02);
  EXPECT_FALSE(schedule.active(FaultKind::kLoss, 1.2));
}

/// Packets that leave a line in `n` periods of a millisecond, as sequence numbers with their
/// period.
std::vector<std::pair<int, int>> leaves(const std::vector<Fault>& faults, int n,
                                        std::uint64_t seed = 1) {
  Line line(FaultSchedule(faults), 1e-3, seed);
  std::vector<std::pair<int, int>> out;
  lwr::fri::MsrPacket msr = lwr::fri::empty_msr();
  for (int i = 0; i < n; ++i) {
    msr.header.send_seq = static_cast<std::uint16_t>(i);
    line.put(msr, 1e-3 * i);
    while (const Line::Packet* packet = line.take(1e-3 * (i + 0.9999)))
      out.emplace_back(packet->msr.header.send_seq, i);
  }
  return out;
}

TEST(Line, WithoutFaultsEverythingLeavesAtOnce) {
  const auto out = leaves({}, 10);
  ASSERT_EQ(out.size(), 10u);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(out[static_cast<std::size_t>(i)], std::make_pair(i, i));
}

TEST(Line, LosesItsRatioReproducibly) {
  const auto out = leaves({parse_fault("loss@0:inf:0.2", kFaults)}, 5000);
  EXPECT_NEAR(static_cast<double>(out.size()), 4000.0, 120.0);
  EXPECT_EQ(out, leaves({parse_fault("loss@0:inf:0.2", kFaults)}, 5000));
  EXPECT_NE(out, leaves({parse_fault("loss@0:inf:0.2", kFaults)}, 5000, 2));
  // Another fault's random numbers do not change which are lost.
  EXPECT_EQ(out, leaves({parse_fault("loss@0:inf:0.2", kFaults),
                         parse_fault("jitter@0:inf:0.0005", kFaults)},
                        5000));
}

TEST(Line, LatePacketsLeaveThatMuchLater) {
  const auto out = leaves({parse_fault("late@0.003:0.002:0.0035", kFaults)}, 12);
  ASSERT_EQ(out.size(), 12u);
  for (const auto& [sequence, period] : out)
    EXPECT_EQ(period - sequence, sequence == 3 || sequence == 4 ? 3 : 0);
}

TEST(Line, ReorderedPacketsLeaveAfterTheirSuccessors) {
  const auto out = leaves({parse_fault("reorder@0.002:0.004", kFaults)}, 8);
  const std::vector<std::pair<int, int>> expected = {{0, 0}, {1, 1}, {3, 3}, {2, 3},
                                                     {5, 5}, {4, 5}, {6, 6}, {7, 7}};
  EXPECT_EQ(out, expected);
}

TEST(Line, DuplicatesLeaveTwice) {
  const auto out = leaves({parse_fault("duplicate@0.001:0.001", kFaults)}, 3);
  const std::vector<std::pair<int, int>> expected = {{0, 0}, {1, 1}, {1, 1}, {2, 2}};
  EXPECT_EQ(out, expected);
}

TEST(Line, JitterStaysWithinItsBound) {
  Line line(FaultSchedule({parse_fault("jitter@0:inf:0.0004", kFaults)}), 1e-3, 1);
  lwr::fri::MsrPacket msr = lwr::fri::empty_msr();
  double least = 1.0, most = 0.0;
  for (int i = 0; i < 1000; ++i) {
    line.put(msr, 1e-3 * i);
    const double delay = line.next_due_s() - 1e-3 * i;
    ASSERT_NE(line.take(1e-3 * (i + 1)), nullptr);
    least = std::min(least, delay), most = std::max(most, delay);
  }
  EXPECT_GE(least, 0.0);
  EXPECT_LT(least, 2e-5);
  EXPECT_LE(most, 4e-4 + 1e-12);
  EXPECT_GT(most, 3.8e-4);
}

}  // namespace
}  // namespace voxtouch::lwr_sim
