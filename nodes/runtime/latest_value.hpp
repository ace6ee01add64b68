#pragma once
/// The newest value of a loop for a slower thread: neither ever waits for the other.
#include <array>
#include <atomic>
#include <cstdint>

namespace voxtouch::runtime {

/// Triple buffer for one writer and one reader. Real-time safe.
template <class T>
class LatestValue {
 public:
  void write(const T& value) noexcept {
    slots_[mine_] = value;
    mine_ = shared_.exchange(static_cast<std::uint8_t>(mine_ | kNew), std::memory_order_acq_rel) & kIndex;
  }
  /// False if nothing has been written since the last read; `value` is then untouched.
  bool read(T& value) noexcept {
    if (!(shared_.load(std::memory_order_relaxed) & kNew)) return false;
    reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    value = slots_[reading_];
    return true;
  }

 private:
  static constexpr std::uint8_t kNew = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> shared_{1};
  std::uint8_t mine_ = 0, reading_ = 2;
};

}  // namespace voxtouch::runtime
