// Missing samples of a bag, found by their sequence numbers.
#include "nodes/logger/sequence_count.hpp"

#include <gtest/gtest.h>

namespace voxtouch::logger {
namespace {

TEST(SequenceCount, FindsGaps) {
  SequenceCount count;
  for (std::uint64_t n = 5; n < 1000; ++n)
    if (n % 10 != 0)
      count.add(1, n);
  EXPECT_EQ(count.of(1).first, 5U);
  EXPECT_EQ(count.of(1).next, 1000U);
  EXPECT_EQ(count.of(1).samples, 995U - 99U);
  EXPECT_EQ(count.of(1).gaps(), 99U);
}

TEST(SequenceCount, CountsNothingTwice) {
  SequenceCount count;
  for (const std::uint64_t n : {0, 1, 1, 2, 0, 3})
    count.add(1, n);
  EXPECT_EQ(count.of(1).samples, 4U);
  EXPECT_EQ(count.of(1).gaps(), 0U);
}

TEST(SequenceCount, KeepsSessionsApartAndStaysBounded) {
  SequenceCount count;
  for (std::uint64_t n = 0; n < 10; ++n)
    count.add(1, n);
  for (std::uint64_t other = 2; other < 100'000; ++other)
    count.add(other, 7);
  for (std::uint64_t n = 10; n < 20; ++n)
    count.add(1, n);
  EXPECT_EQ(count.of(1).samples, 20U);
  EXPECT_EQ(count.of(1).gaps(), 0U);
  EXPECT_EQ(count.of(99'999).samples, 0U);
}

}  // namespace
}  // namespace voxtouch::logger
