#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "nodes/view/picture.hpp"
#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// One sample of a session, all round the ring; the force has this size and the contact this depth.
void sample(Picture& picture, std::uint64_t session, std::int64_t n, double force_n,
            double depth_m) {
  msg::DeviceState state{};
  state.session_id = session, state.sequence_number = static_cast<std::uint64_t>(n),
  state.sample_time_ns = n * kMs;
  picture.take(state, 1'000 * kMs + n * kMs);
  msg::ContactState contact{};
  contact.session_id = session, contact.sequence_number = state.sequence_number;
  contact.sample_time_ns = contact.scene_time_ns = n * kMs;
  contact.deepest_depth_m = depth_m;
  contact.object_pose.orientation.w = contact.tool_pose.orientation.w = 1.0;
  picture.take(contact);
  msg::ForceCommand command{};
  command.session_id = session, command.sequence_number = state.sequence_number,
  command.sample_time_ns = n * kMs;
  command.wrench.force.x = force_n;
  picture.take(command, 1'000 * kMs + n * kMs + 200'000);
}

TEST(ViewPicture, KeepsThePeakOfEachRow) {
  Picture picture;
  for (std::int64_t n = 0; n < 100; ++n)
    sample(picture, 1, n, n == 37 ? -3.0 : 0.1, n == 38 ? 0.004 : 0.001);
  const nlohmann::json rows = picture.frame(nullptr)["rows"];
  ASSERT_GT(rows.size(), 8u);
  EXPECT_DOUBLE_EQ(rows[4][0].get<double>(), 0.032);
  EXPECT_DOUBLE_EQ(rows[4][1].get<double>(), -3.0);
  EXPECT_DOUBLE_EQ(rows[4][4].get<double>(), 3.0);
  EXPECT_DOUBLE_EQ(rows[4][6].get<double>(), 4.0);  // mm
  EXPECT_DOUBLE_EQ(rows[3][4].get<double>(), 0.1);
}

TEST(ViewPicture, GivesEachRowOnceAndAllOfThePastAgain) {
  Picture picture;
  for (std::int64_t n = 0; n < 12'000; ++n)
    sample(picture, 1, n, 0.1, 0.0);
  EXPECT_FALSE(picture.frame(nullptr)["rows"].empty());
  EXPECT_TRUE(picture.frame(nullptr)["rows"].empty());
  EXPECT_FALSE(picture.has_update());
  const nlohmann::json past = picture.past(nullptr)["rows"];
  EXPECT_NEAR(past.back()[0].get<double>() - past.front()[0].get<double>(), kPastS, 0.02);
}

TEST(ViewPicture, RestartsWithASession) {
  Picture picture;
  for (std::int64_t n = 0; n < 100; ++n)
    sample(picture, 1, n, 0.1, 0.0);
  sample(picture, 2, 0, 0.2, 0.0);
  EXPECT_EQ(picture.frame(nullptr)["session"], "2");
  EXPECT_TRUE(picture.past(nullptr)["rows"].empty());
  msg::ContactState stray{};
  stray.session_id = 1, stray.deepest_depth_m = 1.0;
  picture.take(stray);
  EXPECT_EQ(picture.frame(nullptr)["depth"], 0);
}

TEST(ViewPicture, IgnoresInvalidStamps) {
  Picture picture;
  sample(picture, 1, 0, 0.1, 0.0);
  for (std::int64_t n = 0; n < 20'000; ++n) {
    msg::ForceCommand command{};
    command.session_id = 1;
    command.sample_time_ns = n * 1'000'003 * kMs;
    picture.take(command, 0);
  }
  EXPECT_LT(picture.frame(nullptr)["rows"].size(), 4100u);
}

TEST(ViewPicture, CountsLatencyFromWriteToWrite) {
  Picture picture;
  for (std::int64_t n = 0; n < 100; ++n)
    sample(picture, 1, n, 0.1, 0.0);
  const nlohmann::json latency = picture.latency();
  EXPECT_EQ(latency["samples"], 100);
  EXPECT_EQ(latency["p50_us"], 200.0);
  EXPECT_EQ(latency["counts"][8], 100);
}

TEST(ViewPicture, OmitsNonFiniteValues) {
  EXPECT_TRUE(rounded(std::numeric_limits<double>::quiet_NaN()).is_null());
  EXPECT_TRUE(rounded(std::numeric_limits<double>::infinity()).is_null());
  EXPECT_EQ(rounded(1.23456789), 1.23457);
  EXPECT_EQ(rounded(-0.000123456789), -0.000123457);
  EXPECT_EQ(rounded(std::numeric_limits<double>::denorm_min()),
            std::numeric_limits<double>::denorm_min());
}

}  // namespace
}  // namespace voxtouch::view
