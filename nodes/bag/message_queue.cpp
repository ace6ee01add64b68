#include "nodes/bag/message_queue.hpp"

#include <algorithm>
#include <cstring>

namespace voxtouch::bag {

MessageQueue::MessageQueue(std::size_t bytes, std::size_t messages)
    : bytes_(std::max<std::size_t>(bytes, 1)), slots_(std::max<std::size_t>(messages, 1)) {}

MessageQueue::Push MessageQueue::push(TopicId topic, std::int64_t time_ns, std::span<const std::byte> bytes) noexcept {
  const std::uint64_t capacity = bytes_.size();
  if (bytes.size() > capacity) return Push::kTooLarge;
  const std::scoped_lock lock(push_mutex_);
  const std::uint64_t count = pushed_.load(std::memory_order_relaxed);
  const std::uint64_t popped = popped_.load(std::memory_order_acquire);
  if (count - popped >= slots_.size()) return Push::kFull;
  // A message stands in one piece: one that would reach over the end starts at the front, and the rest of the
  // end stays unused.
  std::uint64_t begin = next_byte_;
  if (begin % capacity + bytes.size() > capacity) begin += capacity - begin % capacity;
  const std::uint64_t end = begin + bytes.size();
  // An empty queue has room for anything, whatever part of the end was skipped.
  if (count != popped && end - freed_bytes_.load(std::memory_order_acquire) > capacity) return Push::kFull;
  if (!bytes.empty()) std::memcpy(bytes_.data() + begin % capacity, bytes.data(), bytes.size());
  slots_[count % slots_.size()] = {topic, static_cast<std::uint32_t>(bytes.size()), time_ns, begin, end};
  next_byte_ = end;
  pushed_.store(count + 1, std::memory_order_release);
  return Push::kQueued;
}

std::optional<MessageQueue::Message> MessageQueue::front() const noexcept {
  const std::uint64_t popped = popped_.load(std::memory_order_relaxed);
  if (popped == pushed_.load(std::memory_order_acquire)) return std::nullopt;
  const Slot& slot = slots_[popped % slots_.size()];
  return Message{slot.topic, slot.time_ns, {bytes_.data() + slot.begin % bytes_.size(), slot.size}};
}

void MessageQueue::pop() noexcept {
  const std::uint64_t popped = popped_.load(std::memory_order_relaxed);
  freed_bytes_.store(slots_[popped % slots_.size()].end, std::memory_order_release);
  popped_.store(popped + 1, std::memory_order_release);
  popped_.notify_all();  // a system call only while somebody waits
}

}  // namespace voxtouch::bag
