#pragma once
/// The bounded queue between reception threads and the disk thread. All memory is taken and touched at
/// construction.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "nodes/bag/bag_sink.hpp"

namespace voxtouch::bag {

/// Many pushers, one popper. The popper takes no lock that a pusher waits for, so nothing the disk does, nor
/// the scheduling of its thread, holds a pusher up; pushers only wait for one another, for the time of one
/// copy.
class MessageQueue {
 public:
  /// Both bounds hold: at most `messages` at a time and `bytes` of payload. Each at least 1.
  MessageQueue(std::size_t bytes, std::size_t messages);

  enum class Push : std::uint8_t { kQueued, kFull, kTooLarge };
  /// Copies the message in. kFull: no room now; kTooLarge: it would not fit into the empty queue either.
  /// Allocates nothing.
  Push push(TopicId topic, std::int64_t time_ns, std::span<const std::byte> bytes) noexcept;

  struct Message {
    TopicId topic;
    std::int64_t time_ns;
    std::span<const std::byte> bytes;  ///< inside the queue, until pop()
  };
  /// The oldest message. Popper only.
  std::optional<Message> front() const noexcept;
  /// Gives the room of front() back. Popper only.
  void pop() noexcept;

  /// Blocks until something was popped after `seen`, a value of pops() read before the push that found no
  /// room.
  void wait_for_pop(std::uint64_t seen) const noexcept { popped_.wait(seen, std::memory_order_acquire); }
  std::uint64_t pops() const noexcept { return popped_.load(std::memory_order_acquire); }
  bool empty() const noexcept { return pops() == pushed_.load(std::memory_order_acquire); }

 private:
  struct Slot {
    TopicId topic;
    std::uint32_t size;
    std::int64_t time_ns;
    std::uint64_t begin, end;  // positions that only grow; modulo the capacity they are places in bytes_
  };
  std::vector<std::byte> bytes_;
  std::vector<Slot> slots_;
  std::mutex push_mutex_;
  std::uint64_t next_byte_ = 0;           // under push_mutex_
  std::atomic<std::uint64_t> pushed_{0};  // messages
  std::atomic<std::uint64_t> popped_{0};
  std::atomic<std::uint64_t> freed_bytes_{0};  // end of the last popped message
};

}  // namespace voxtouch::bag
