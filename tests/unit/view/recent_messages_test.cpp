#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <random>

#include "nodes/view/recent_messages.hpp"
#include "tests/support/process/forked.hpp"
#include "tests/support/process/process.hpp"
#include "tests/support/whole_bag.hpp"

namespace voxtouch::view {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::size_t kStream = 0, kPlan = 1;

/// Noise: compression finds nothing in it.
std::vector<std::byte> bytes_of(std::size_t size) {
  static std::mt19937 random(45);
  std::vector<std::byte> bytes(size);
  for (std::byte& byte : bytes)
    byte = static_cast<std::byte>(random());
  return bytes;
}

/// A hundred a second for 25 s, and a plan at the begin.
RecentMessages recent_after_25_s() {
  RecentMessages recent({false, true});
  recent.add(kPlan, 0, bytes_of(3));
  recent.add(kPlan, kSecond, bytes_of(4));
  for (std::int64_t n = 0; n <= 2500; ++n)
    recent.add(kStream, n * kSecond / 100, bytes_of(300));
  return recent;
}

TEST(RecentMessages, KeepsTenSecondsAndTheLastPlan) {
  const std::vector<RecentMessage> all = recent_after_25_s().all();
  ASSERT_EQ(all.size(), 1002u);
  EXPECT_EQ(all[0].topic, kPlan);
  EXPECT_EQ(all[0].bytes.size(), 4u);
  EXPECT_EQ(all[0].written_ns, 15 * kSecond);
  EXPECT_EQ(all[1].written_ns, 15 * kSecond);
  EXPECT_EQ(all.back().written_ns, 25 * kSecond);
  EXPECT_TRUE(std::ranges::is_sorted(all, {}, &RecentMessage::written_ns));
}

TEST(RecentMessages, KeepAPlanThatArrivesLate) {
  RecentMessages recent({false, true});
  recent.add(kStream, 100 * kSecond, bytes_of(8));
  recent.add(kPlan, kSecond, bytes_of(4));
  const std::vector<RecentMessage> all = recent.all();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].topic, kPlan);
  EXPECT_EQ(all[0].written_ns, 100 * kSecond);
}

TEST(RecentMessages, AreBoundedInMemory) {
  RecentMessages recent({false});
  const std::vector<std::byte> large = bytes_of(1 << 20);
  for (std::int64_t n = 0; n < 100; ++n)
    recent.add(0, n, large);
  EXPECT_EQ(recent.all().size(), RecentMessages::kMaxBytes >> 20);
}

const std::vector<bag::TopicInfo> kTopics{
    {"/haptic/device/state", "voxtouch_msgs/msg/DeviceState", "cdr", "", 0},
    {"/haptic/rendering/plan", "voxtouch_msgs/msg/ScenePlan", "cdr", "", 0}};

TEST(RecentMessages, BecomeARecording) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_recording(folder / "run", kTopics, recent_after_25_s().all()));
  const auto bag = bag::WholeBag::open(folder / "run");
  ASSERT_TRUE(bag);
  EXPECT_EQ(bag->message_count(), 1002u);
}

TEST(RecentMessages, LeaveNothingBehindOnAFullDisk) {
  const test::TemporaryFolder folder;
  test::Forked child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100'000, 100'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const auto written = write_recording(folder / "run", kTopics, recent_after_25_s().all());
    return !written && !written.error().sentence.empty() ? 0 : 1;
  });
  EXPECT_EQ(child.wait().status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

}  // namespace
}  // namespace voxtouch::view
