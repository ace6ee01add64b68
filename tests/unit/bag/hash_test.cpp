#include "tests/support/bag_hash.hpp"

#include "nodes/bag/bag_writer.hpp"
#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag {
namespace {

using namespace test;

// One topic "/t" with these messages, stored in this order.
Result<TopicHash> hash_of(const std::vector<std::vector<std::byte>>& messages, const KeyOf& key,
                          std::int64_t first_time = 0) {
  const TemporaryFolder folder;
  auto writer = expect_value(BagWriter::create(folder / "run"));
  const TopicId topic = expect_value(writer.add_topic({"/t", "p/msg/T", "cdr", "", 0}));
  for (const auto& message : messages)
    EXPECT_GOOD(writer.append(topic, first_time++, message));
  EXPECT_GOOD(writer.close());
  return hash_topic(expect_value(WholeBag::open(folder / "run")), "/t", key);
}

TEST(TopicHash, DependsOnSequenceNotOnArrivalOrTime) {
  const auto a = ring_message(1, 0), b = ring_message(1, 1), c = ring_message(1, 2);
  const auto in_order = expect_value(hash_of({a, b, c}, ring_sequence_number));
  EXPECT_EQ(in_order.messages, 3u);
  EXPECT_EQ(in_order, expect_value(hash_of({c, a, b}, ring_sequence_number, 5000)));
  EXPECT_NE(in_order.hash, expect_value(hash_of({c, a, b}, {})).hash);
  EXPECT_EQ(in_order, expect_value(hash_of({a, b, c}, {})));
}

TEST(TopicHash, ChangesWithOneBitALostMessageOrAnotherSplit) {
  const auto a = ring_message(1, 0), b = ring_message(1, 1);
  auto flipped = b;
  flipped.back() ^= std::byte{1};
  const auto whole = expect_value(hash_of({a, b}, ring_sequence_number));
  EXPECT_NE(whole.hash, expect_value(hash_of({a, flipped}, ring_sequence_number)).hash);
  EXPECT_NE(whole.hash, expect_value(hash_of({a}, ring_sequence_number)).hash);
  const std::byte x{120};
  EXPECT_NE(expect_value(hash_of({{x, x}, {x}}, {})).hash,
            expect_value(hash_of({{x}, {x, x}}, {})).hash);
}

TEST(TopicHash, HasItsGoldenValue) {
  // FNV-1a over eight zero bytes of length is a constant of the format, worked out by hand with
  // another program.
  EXPECT_EQ(expect_value(hash_of({}, {})).hash, 0xcbf29ce484222325U);
  EXPECT_EQ(expect_value(hash_of({{}}, {})).hash, 0xa8c7f832281a39c5U);
}

TEST(TopicHash, ReadsTheSequenceNumberInTheMessagesOwnByteOrder) {
  auto big = ring_message(0, 0);
  big[1] = std::byte{0};
  big[19] = std::byte{5};
  EXPECT_EQ(ring_sequence_number(big), 5u);
  EXPECT_EQ(ring_sequence_number(ring_message(7, 258)), 258u);
  EXPECT_EQ(ring_sequence_number(std::vector<std::byte>(19)), std::nullopt);
}

TEST(TopicHash, ReportsAMissingSequenceNumberOrTopic) {
  const auto short_one = hash_of({std::vector<std::byte>(8)}, ring_sequence_number);
  ASSERT_FALSE(short_one);
  EXPECT_TRUE(says(short_one, "number")) << short_one.error().sentence;
  const TemporaryFolder folder;
  EXPECT_GOOD(expect_value(BagWriter::create(folder / "run")).close());
  EXPECT_TRUE(
      says(hash_topic(expect_value(WholeBag::open(folder / "run")), "/t"), "no topic '/t'"));
}

}  // namespace
}  // namespace voxtouch::bag
