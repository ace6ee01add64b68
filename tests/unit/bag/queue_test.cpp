#include "nodes/bag/message_queue.hpp"

#include <deque>
#include <random>
#include <thread>

#include "tests/unit/bag/support.hpp"

namespace voxtouch::bag {
namespace {

using Push = MessageQueue::Push;

std::vector<std::byte> block(std::size_t size, std::uint64_t seed) {
  std::vector<std::byte> bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(seed * 7 + i);
  return bytes;
}

TEST(MessageQueue, BoundsMessagesAndBytes) {
  MessageQueue few(1000, 2);
  EXPECT_EQ(few.push(0, 0, block(10, 0)), Push::kQueued);
  EXPECT_EQ(few.push(0, 0, block(10, 0)), Push::kQueued);
  EXPECT_EQ(few.push(0, 0, block(10, 0)), Push::kFull);
  few.pop();
  EXPECT_EQ(few.push(0, 0, block(10, 0)), Push::kQueued);

  MessageQueue small(100, 1000);
  EXPECT_EQ(small.push(0, 0, block(60, 0)), Push::kQueued);
  EXPECT_EQ(small.push(0, 0, block(60, 0)), Push::kFull);
  EXPECT_EQ(small.push(0, 0, block(101, 0)), Push::kTooLarge);
}

TEST(MessageQueue, TakesAMessageOfItsWholeSizeWheneverItIsEmpty) {
  MessageQueue queue(100, 10);
  for (std::size_t skew = 1; skew < 100; ++skew) {
    ASSERT_EQ(queue.push(0, 0, block(skew, 0)), Push::kQueued);
    queue.pop();
    ASSERT_EQ(queue.push(0, 0, block(100, skew)), Push::kQueued) << skew;
    EXPECT_TRUE(std::ranges::equal(queue.front()->bytes, block(100, skew)));
    queue.pop();
  }
}

TEST(MessageQueue, NeverMixesMessagesUpWhateverTheirSizes) {
  std::mt19937 random(4711);
  MessageQueue queue(257, 7);
  std::deque<std::pair<TopicId, std::vector<std::byte>>> model;
  std::uint64_t full = 0;
  for (std::uint64_t step = 0; step < 20000; ++step) {
    if (random() % 2 == 0) {
      const auto bytes = block(random() % 120, step);
      const auto topic = static_cast<TopicId>(step % 5);
      const auto pushed = queue.push(topic, static_cast<std::int64_t>(step), bytes);
      if (pushed == Push::kQueued) model.emplace_back(topic, bytes);
      full += pushed == Push::kFull;
    } else if (const auto message = queue.front()) {
      ASSERT_FALSE(model.empty());
      ASSERT_EQ(message->topic, model.front().first);
      ASSERT_TRUE(std::ranges::equal(message->bytes, model.front().second)) << "step " << step;
      queue.pop();
      model.pop_front();
    } else {
      ASSERT_TRUE(model.empty());
    }
  }
  EXPECT_GT(full, 100u);
}

TEST(MessageQueue, KeepsEachPushersOrderAcrossThreads) {
  MessageQueue queue(4096, 64);
  constexpr std::uint64_t kEach = 5000;
  const auto pusher = [&](TopicId topic) {
    for (std::uint64_t i = 0; i < kEach;) {
      const std::uint64_t seen = queue.pops();
      if (queue.push(topic, static_cast<std::int64_t>(i), block(1 + i % 50, i)) == Push::kQueued)
        ++i;
      else
        queue.wait_for_pop(seen);
    }
  };
  std::thread first(pusher, 0), second(pusher, 1);
  std::uint64_t next[2] = {0, 0};
  bool right = true;
  while (next[0] + next[1] < 2 * kEach) {
    const auto message = queue.front();
    if (!message) {
      std::this_thread::yield();
      continue;
    }
    const std::uint64_t i = next[message->topic]++;
    right = right && message->time_ns == static_cast<std::int64_t>(i) &&
        std::ranges::equal(message->bytes, block(1 + i % 50, i));
    queue.pop();
  }
  first.join();
  second.join();
  EXPECT_TRUE(right);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace voxtouch::bag
