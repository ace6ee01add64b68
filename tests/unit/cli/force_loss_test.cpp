// When force counts as lost, and for how long.
#include "nodes/device/force_loss.hpp"

#include <gtest/gtest.h>

namespace voxtouch::device_node {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(ForceLoss, LastsUntilTheGuardPassesCommandsWholeAgain) {
  ForceLoss loss;
  for (std::int64_t t = 0; t <= 100; ++t)
    loss.note(t * kMs, true, 5.0);
  for (std::int64_t t = 101; t < 180; ++t)
    loss.note(t * kMs, false, 5.0 - 0.05 * static_cast<double>(t - 100));
  EXPECT_EQ(loss.count(), 1U);
  EXPECT_EQ(loss.longest_ns(), 79 * kMs) << "it goes on";
  loss.note(180 * kMs, true, 5.0);
  EXPECT_EQ(loss.total_ns(), 80 * kMs);
  for (std::int64_t t = 181; t < 300; ++t)
    loss.note(t * kMs, true, 5.0);
  loss.note(500 * kMs, false, 0.0);  // the process was suspended
  loss.note(520 * kMs, true, 1.0);
  EXPECT_EQ(loss.count(), 2U);
  EXPECT_EQ(loss.total_ns(), (80 + 221) * kMs);
  EXPECT_EQ(loss.longest_ns(), 221 * kMs);
}

TEST(ForceLoss, IsNoneWithoutForceAndNoneWhileItRampsIn) {
  ForceLoss loss;
  for (std::int64_t t = 0; t < 500; ++t)
    loss.note(t * kMs, false, 0.01 * static_cast<double>(t));
  for (std::int64_t t = 500; t < 600; ++t)
    loss.note(t * kMs, true, 0.0);
  for (std::int64_t t = 600; t < 700; ++t)
    loss.note(t * kMs, false, 0.0);
  EXPECT_EQ(loss.count(), 0U);
  EXPECT_EQ(loss.total_ns(), 0);
}

}  // namespace
}  // namespace voxtouch::device_node
