#pragma once
/// A short queue from one thread to another: neither ever waits for the other.
#include <array>
#include <atomic>
#include <cstddef>
#include <span>

namespace voxtouch::runtime {

/// One thread pushes, one looks and pops. Real-time safe for values that are.
template <class T, std::size_t kCapacity>
class SpscQueue {
 public:
  /// False, and nothing happened, where it is full.
  bool push(const T& value) noexcept { return push(std::span(&value, 1)); }
  /// All of them or none: the other thread sees no part.
  bool push(std::span<const T> values) noexcept {
    if (room() < values.size())
      return false;
    std::size_t end = end_.load(std::memory_order_relaxed);
    for (const T& value : values)
      slots_[end++ % kCapacity] = value;
    end_.store(end, std::memory_order_release);
    return true;
  }
  /// The oldest, null where there is none; stays where it is until `pop`.
  const T* front() const noexcept {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    return begin == end_.load(std::memory_order_acquire) ? nullptr : &slots_[begin % kCapacity];
  }
  void pop() noexcept {
    begin_.store(begin_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  /// Of the pushing thread: how many more go in for certain.
  std::size_t room() const noexcept {
    return kCapacity -
           (end_.load(std::memory_order_relaxed) - begin_.load(std::memory_order_acquire));
  }

 private:
  std::array<T, kCapacity> slots_{};
  std::atomic<std::size_t> begin_{0}, end_{0};
};

}  // namespace voxtouch::runtime
