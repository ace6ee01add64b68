#include "nodes/bus/following.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "nodes/bus/latched_reader.hpp"
#include "nodes/bus/writer.hpp"
#include "tests/support/process/process.hpp"

namespace voxtouch::bus {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;

class FollowedLatched : public testing::Test {
 protected:
  Writer<msg::DeviceDescription> writer_of(const Participant& participant) const {
    return {participant, qos::kDeviceDescription, "r", qos::profile(qos::ProfileId::kLatched)};
  }
  static void say(Writer<msg::DeviceDescription>& writer, std::uint64_t session) {
    static char model[] = "m", grip[] = "pen";
    msg::DeviceDescription value{};
    value.model = model, value.grip = grip, value.session_id = session;
    writer.write(value);
  }
  /// The session of a sample taken within `patience`; 0: none.
  std::uint64_t taken(milliseconds patience = seconds(10)) {
    std::uint64_t session = 0;
    const auto until = std::chrono::steady_clock::now() + patience;
    while (session == 0 && std::chrono::steady_clock::now() < until) {
      reader.take([&](const msg::DeviceDescription& value) { session = value.session_id; });
      std::this_thread::sleep_for(milliseconds(5));
    }
    return session;
  }
  bool matches(std::uint32_t writers) {
    const auto until = std::chrono::steady_clock::now() + seconds(10);
    while (reader.matched_count() != writers && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(milliseconds(5));
    return reader.matched_count() == writers;
  }

  std::uint32_t domain = static_cast<std::uint32_t>(std::stoul(test::fresh_domain()));
  Participant own{{domain, "lo", "own", {}, {}, {}}}, other{{domain, "lo", "other", {}, {}, {}}},
      unauthorised{{domain, "lo", "unauthorised", {}, {}, {}}};
  LatchedReader<msg::DeviceDescription> reader{own, qos::kDeviceDescription, "r"};
};

/// As after a network split that is longer than the lease: the participant is the same, its writer
/// has another handle, and latched samples arrive again at once, before the node polls.
TEST_F(FollowedLatched, TakesSamplesOfARediscoveredWriter) {
  std::optional<Writer<msg::DeviceDescription>> writer(writer_of(other));
  say(*writer, 7);
  ASSERT_TRUE(matches(1));
  ASSERT_TRUE(reader.following().follow(other.guid()));
  EXPECT_EQ(taken(), 7U);
  writer.reset();
  ASSERT_TRUE(matches(0));
  writer.emplace(writer_of(other));
  ASSERT_TRUE(matches(1));
  say(*writer, 8);
  std::this_thread::sleep_for(
      milliseconds(200));  // it arrives while a writer is followed that has left
  EXPECT_EQ(taken(milliseconds(20)), 0U);
  ASSERT_TRUE(reader.following().follow(other.guid()));
  EXPECT_EQ(taken(), 8U);
}

TEST_F(FollowedLatched, RefusesOthersWhileTheFollowedWriterIsThere) {
  Writer<msg::DeviceDescription> writer = writer_of(other);
  say(writer, 7);
  ASSERT_TRUE(matches(1));
  ASSERT_TRUE(reader.following().follow(other.guid()));
  EXPECT_EQ(taken(), 7U);
  std::optional<Writer<msg::DeviceDescription>> foreign(writer_of(unauthorised));
  ASSERT_TRUE(matches(2));
  say(*foreign, 9);
  for (int n = 0; n < 500 && reader.following().refused() == 0; ++n)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(reader.following().refused(), 1U);
  foreign.reset();  // another program has left, which changes nothing
  ASSERT_TRUE(matches(1));
  foreign.emplace(writer_of(unauthorised));
  ASSERT_TRUE(matches(2));
  say(*foreign, 9);
  for (int n = 0; n < 500 && reader.following().refused() == 1; ++n)
    std::this_thread::sleep_for(milliseconds(10));
  EXPECT_EQ(reader.following().refused(), 2U);
  EXPECT_EQ(taken(milliseconds(20)), 0U);
}

}  // namespace
}  // namespace voxtouch::bus
