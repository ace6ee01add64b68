// When force counts as lost, and for how long.
#include "nodes/device/force_loss.hpp"

#include <gtest/gtest.h>

namespace voxtouch::device_node {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(ForceLoss, LastsUntilTheGuardPassesCommandsWholeAgain) {
  ForceLoss loss;
  for (std::int64_t t = 0; t <= 100; ++t)
    loss.note(t * kMs, 1.0, 5.0);
  for (std::int64_t t = 101; t < 180; ++t) {
    const double fraction = 1.0 - 0.01 * static_cast<double>(t - 100);
    loss.note(t * kMs, fraction, 5.0 * fraction);
  }
  EXPECT_EQ(loss.count(), 1U);
  EXPECT_EQ(loss.longest_ns(), 79 * kMs) << "it goes on";
  loss.note(180 * kMs, 1.0, 5.0);
  EXPECT_EQ(loss.total_ns(), 80 * kMs);
  for (std::int64_t t = 181; t < 300; ++t)
    loss.note(t * kMs, 1.0, 5.0);
  loss.note(500 * kMs, 0.0, 0.0);  // the process stood still
  loss.note(520 * kMs, 1.0, 1.0);
  EXPECT_EQ(loss.count(), 2U);
  EXPECT_EQ(loss.total_ns(), (80 + 221) * kMs);
  EXPECT_EQ(loss.longest_ns(), 221 * kMs);
}

TEST(ForceLoss, IsNoneWithoutForceAndNoneWhileItRampsIn) {
  ForceLoss loss;
  for (std::int64_t t = 0; t < 500; ++t)
    loss.note(t * kMs, 0.002 * static_cast<double>(t), 0.01 * static_cast<double>(t));
  for (std::int64_t t = 500; t < 600; ++t)
    loss.note(t * kMs, 1.0, 0.0);
  for (std::int64_t t = 600; t < 700; ++t)
    loss.note(t * kMs, 0.01 * static_cast<double>(699 - t), 0.0);
  EXPECT_EQ(loss.count(), 0U);
  EXPECT_EQ(loss.total_ns(), 0);
}

TEST(ForceLoss, DuringTheFirstRampIsCounted) {
  ForceLoss loss;
  for (std::int64_t t = 0; t < 400; ++t)
    loss.note(t * kMs, 0.002 * static_cast<double>(t), 1.0);
  loss.note(600 * kMs, 0.0, 0.0);  // the process stood still
  for (std::int64_t t = 601; t <= 1100; ++t)
    loss.note(t * kMs, 0.002 * static_cast<double>(t - 600), 1.0);
  EXPECT_EQ(loss.count(), 1U);
  EXPECT_EQ(loss.total_ns(), 701 * kMs);
}

}  // namespace
}  // namespace voxtouch::device_node
