// Rows kept before a fault, and how they are written to disk.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "nodes/faults/fault_latch.hpp"
#include "nodes/faults/fault_recorder.hpp"
#include "tests/ring/ring_run.hpp"

namespace voxtouch::faults {
namespace {

constexpr const char* kReason = "a test";

std::vector<int> taken(RecentRows<int>& rows) {
  std::vector<int> all;
  rows.take([&](const char*, const std::vector<int>& kept) { all = kept; });
  return all;
}

TEST(RecentRows, AreTheNewestOldestFirst) {
  RecentRows<int> rows;
  rows.reserve(4);
  for (int n = 1; n <= 3; ++n)
    rows.push(n);
  EXPECT_TRUE(rows.keep(kReason));
  EXPECT_EQ(taken(rows), (std::vector{1, 2, 3}));
  for (int n = 4; n <= 13; ++n)
    rows.push(n);
  EXPECT_TRUE(rows.keep(kReason));
  EXPECT_EQ(taken(rows), (std::vector{10, 11, 12, 13}));
}

TEST(RecentRows, AreKeptUntilTaken) {
  RecentRows<int> rows;
  rows.reserve(2);
  rows.push(1);
  EXPECT_TRUE(rows.keep(kReason));
  for (int n = 2; n < 9; ++n)
    rows.push(n);
  EXPECT_FALSE(rows.keep("another test"));
  EXPECT_FALSE(rows.reserve(5));
  EXPECT_EQ(taken(rows), std::vector{1});
  EXPECT_EQ(taken(rows), std::vector<int>{}) << "taken once";
  EXPECT_TRUE(rows.keep("another test"));
  EXPECT_EQ(taken(rows), (std::vector{7, 8}));
}

TEST(RecentRows, RepeatedReasonNeedsAllNewRows) {
  RecentRows<int> rows;
  rows.reserve(3);
  rows.push(1);
  EXPECT_TRUE(rows.keep(kReason));
  taken(rows);
  rows.push(2), rows.push(3);
  EXPECT_FALSE(rows.keep(kReason));
  rows.push(4);
  EXPECT_TRUE(rows.keep(kReason));
}

TEST(RecentRows, WithoutMemoryKeepNothing) {
  RecentRows<int> rows;
  rows.push(1);
  EXPECT_FALSE(rows.keep(kReason));
}

struct Row {
  msg::DeviceState state;
};

std::unique_ptr<FaultRecorder<Row>> recorder_in(const std::filesystem::path& folder) {
  auto recorder = std::make_unique<FaultRecorder<Row>>(
      folder, FaultContext{"device", "left", {}},
      std::vector{topic_of<msg::DeviceState>("/left/device/state")},
      [](const std::vector<Row>& rows) {
        std::vector<FaultMessage> messages;
        for (const Row& row : rows)
          messages.push_back(message_of(0, row.state.sample_time_ns, row.state));
        return messages;
      });
  recorder->reserve(1000.0);
  return recorder;
}

void push(FaultRecorder<Row>& recorder, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t n = first; n < last; ++n) {
    Row row{};
    row.state.sequence_number = n,
    row.state.sample_time_ns = static_cast<std::int64_t>(n) * 1'000'000;
    recorder.push(row);
  }
}

TEST(FaultRecorder, KeepsTwoSecondsPerFaultUpToTheMaximum) {
  const test::TemporaryFolder folder;
  constexpr const char* kReasons[] = {"one", "another"};
  {
    const auto recorder = recorder_in(folder / "faults");
    for (std::uint64_t n = 0; n < kMaxRecords + 2; ++n) {
      push(*recorder, 3000 * n, 3000 * (n + 1));
      recorder->keep(kReasons[n % 2]);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    runtime::NodeReport report;
    recorder->report_to(report);
    EXPECT_GE(report.figures["fault_records"].value, 5.0)
        << "a slow disk misses some, and the loop does not wait";
  }
  const auto states =
      test::read_ring_topic<msg::DeviceState>(folder / "faults/device_1", "/left/device/state");
  ASSERT_EQ(states.size(), 2000U);
  EXPECT_EQ(states.front().sequence_number, 1000U);
  EXPECT_EQ(states.back().sequence_number, 2999U);
  const std::vector<std::string> reported = fault_records_in(folder / "faults");
  EXPECT_LE(reported.size(), kMaxRecords);
  EXPECT_NE(reported.at(0).find(" 2.0 s before another,"), std::string::npos) << reported.at(0);
}

TEST(FaultRecorder, ReportsADiskErrorAndContinues) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "faults") << "a file where the folder should be";
  const auto recorder = recorder_in(folder / "faults");
  push(*recorder, 0, 10);
  recorder->keep(kReason);
  runtime::NodeReport report;
  for (int n = 0; n < 200 && !report.values.contains("fault_record_error"); ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    recorder->report_to(report);
  }
  EXPECT_NE(report.values["fault_record_error"].find("faults"), std::string::npos);
  EXPECT_FALSE(report.values.contains("fault_record"));
}

TEST(FaultLatch, IsResetByItsOwnNumberOnlyOnce) {
  const auto number_of = [](const FaultLatch& latch) {
    runtime::NodeReport report;
    latch.report_to(report);
    return std::stoull("0" + report.values[FaultLatch::kNumber]);
  };
  FaultLatch latch;
  latch.reset(0);
  EXPECT_FALSE(latch.take_reset()) << "nothing is latched";
  latch.latch("of a test");
  const auto first = number_of(latch);
  ASSERT_NE(first, 0U);
  latch.latch("of another");
  EXPECT_EQ(number_of(latch), first) << "a fault is latched already";
  latch.reset(first - 1);
  EXPECT_FALSE(latch.take_reset());
  EXPECT_TRUE(latch.latched());
  latch.reset(first);
  EXPECT_TRUE(latch.take_reset());
  EXPECT_FALSE(latch.latched());
  EXPECT_FALSE(latch.take_reset());
  latch.latch("of a test");
  latch.reset(first);
  EXPECT_FALSE(latch.take_reset()) << "reset before, or recorded";
  EXPECT_NE(number_of(latch), first);
}

TEST(FaultRecorder, ReportsEachRecordOfAnotherNodeOnce) {
  ReportedFaults seen;
  runtime::NodeReport other;
  EXPECT_FALSE(seen.is_new(other));
  other.figures[ReportedFaults::kFigure] = {1.0, "records"};
  EXPECT_TRUE(seen.is_new(other));
  EXPECT_FALSE(seen.is_new(other));
  other.figures[ReportedFaults::kFigure] = {0.0, "records"};
  EXPECT_FALSE(seen.is_new(other)) << "it was started anew";
}

}  // namespace
}  // namespace voxtouch::faults
