#pragma once
/// Selects the samples of a loop that the visualisation receives.
#include <cstdint>

namespace voxtouch::runtime {

/// Selects 100 samples a second by the given clock, independent of the loop's rate. Real-time safe.
class DisplaySampler {
 public:
  static constexpr std::int64_t kPeriodNs = 10'000'000, kMaxMadeUp = 10;
  /// Whether the sample at `now_ns` is selected. A smaller `now_ns` than in the last call starts a
  /// new session in simulated time. After a gap, up to ten missed samples are made up for by the
  /// samples that follow.
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
