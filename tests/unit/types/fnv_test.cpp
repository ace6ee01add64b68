#include "core/types/fnv.hpp"

#include <gtest/gtest.h>

namespace voxtouch {
namespace {

std::uint64_t hash_of(std::string_view text) {
  Fnv1a hash;
  hash.add(text);
  return hash.value();
}

/// Published with the algorithm (draft-eastlake-fnv, appendix C).
TEST(Fnv1a, GivesThePublishedValues) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325U);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cU);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8U);
}

TEST(Fnv1a, IsIndependentOfHowBytesAreSplit) {
  Fnv1a parts;
  parts.add("foo"), parts.add(""), parts.add("bar");
  EXPECT_EQ(parts.value(), hash_of("foobar"));
}

TEST(Fnv1a, TakesBytesAboveHalfAsThemselves) {
  EXPECT_EQ(hash_of("\xff"), (0xcbf29ce484222325U ^ 0xffU) * 0x100000001b3U);
}

}  // namespace
}  // namespace voxtouch
