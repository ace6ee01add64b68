#include "core/types/latest_value.hpp"

#include <gtest/gtest.h>

namespace voxtouch {
namespace {

TEST(LatestValue, GivesTheNewestOnceAndReportsLosses) {
  LatestValue<int> slot;
  int out = -1;
  EXPECT_FALSE(slot.take(out));
  EXPECT_EQ(out, -1);
  EXPECT_FALSE(slot.put(1));
  EXPECT_TRUE(slot.put(2));
  EXPECT_TRUE(slot.take(out));
  EXPECT_EQ(out, 2);
  EXPECT_FALSE(slot.take(out));
  EXPECT_FALSE(slot.put(3));
  EXPECT_TRUE(slot.take(out));
  EXPECT_EQ(out, 3);
}

}  // namespace
}  // namespace voxtouch
