#pragma once
/// A short queue between two threads. Neither thread waits for the other.
#include <array>
#include <atomic>
#include <cstddef>
#include <span>

namespace voxtouch::runtime {

/// One thread pushes, one thread reads and pops. Real-time safe if T is.
template <class T, std::size_t kCapacity>
class SpscQueue {
 public:
  /// Returns false, without any effect, if the queue is full.
  bool push(const T& value) noexcept { return push(std::span(&value, 1)); }
  /// Pushes all values or none. The other thread never observes a part of them.
  bool push(std::span<const T> values) noexcept {
    if (room() < values.size())
      return false;
    std::size_t end = end_.load(std::memory_order_relaxed);
    for (const T& value : values)
      slots_[end++ % kCapacity] = value;
    end_.store(end, std::memory_order_release);
    return true;
  }
  /// The oldest value, or null if the queue is empty. It stays in place until `pop`.
  const T* front() const noexcept {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    return begin == end_.load(std::memory_order_acquire) ? nullptr : &slots_[begin % kCapacity];
  }
  void pop() noexcept {
    begin_.store(begin_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  /// Called by the pushing thread: a lower bound of the free places.
  std::size_t room() const noexcept {
    return kCapacity -
           (end_.load(std::memory_order_relaxed) - begin_.load(std::memory_order_acquire));
  }

 private:
  std::array<T, kCapacity> slots_{};
  std::atomic<std::size_t> begin_{0}, end_{0};
};

}  // namespace voxtouch::runtime
