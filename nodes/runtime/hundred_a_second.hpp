#pragma once
/// Which samples of a loop are shown to who looks on.
#include <cstdint>

namespace voxtouch::runtime {

/// A hundred a second by the clock that it is given, whatever the loop's own rate. Real-time safe.
class HundredASecond {
 public:
  static constexpr std::int64_t kPeriodNs = 10'000'000, kMaxMadeUp = 10;
  /// Whether the sample at `now_ns` (less than before: simulated time of a new session) is one of
  /// them. For those that a loop could not give while it stood still, ten at most, it gives as many
  /// of the samples that follow.
  bool is_due(std::int64_t now_ns) noexcept {
    const std::int64_t period = now_ns / kPeriodNs;
    if (period - next_ > kMaxMadeUp || next_ - period > 1)
      next_ = period;
    if (period < next_)
      return false;
    ++next_;
    return true;
  }

 private:
  std::int64_t next_ = 0;
};

}  // namespace voxtouch::runtime
