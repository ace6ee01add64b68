#include "nodes/coupling/ring_messages.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace voxtouch::coupling_node {
namespace {

TEST(RingMessages, ACommandsTimeLimitIsNeverBeforeItsSample) {
  msg::ContactState contact{};
  for (const std::int64_t time : {INT64_MIN, std::int64_t{0}, INT64_MAX}) {
    contact.sample_time_ns = time;
    EXPECT_GE(force_command(contact, {}, {}, 0.005).valid_until_ns, time);
  }
}

TEST(RingMessages, CommandReportsInjectedAndBoundedDamping) {
  coupling::CouplingOutput out;
  EXPECT_EQ(force_command({}, out, {}, 0.005).status, 0U);
  out.bounded = true, out.injected_n = 0.25;
  const msg::ForceCommand command = force_command({}, out, {}, 0.005);
  EXPECT_EQ(command.status, msg::force_command::kStatusBounded);
  EXPECT_EQ(command.injected_n, 0.25F);
}

}  // namespace
}  // namespace voxtouch::coupling_node
