#pragma once
/// Passes the newest value from one thread to another; neither waits for the other.
#include <array>
#include <atomic>

namespace voxtouch {

/// Triple buffer for one writer and one reader; wait-free on both sides, real-time safe. Each value
/// is taken once at most.
template <class T>
class LatestValue {
 public:
  /// Returns true if the previous value was not taken and is lost.
  bool put(const T& value) noexcept {
    slots_[back_] = value;
    const unsigned before = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel);
    back_ = before & kIndex;
    return (before & kFresh) != 0;
  }
  /// Returns false without a new value; `out` is then unchanged.
  bool take(T& out) noexcept {
    if ((middle_.load(std::memory_order_acquire) & kFresh) == 0)
      return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    out = slots_[front_];
    return true;
  }

 private:
  static constexpr unsigned kIndex = 3, kFresh = 4;
  std::array<T, 3> slots_{};
  std::atomic<unsigned> middle_{1};
  unsigned back_ = 0, front_ = 2;  // used by the writer and by the reader only
};

}  // namespace voxtouch
