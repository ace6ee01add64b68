#pragma once
/// Latency histogram in fixed storage, which a loop can update.
#include <array>
#include <atomic>
#include <cstdint>

namespace voxtouch::runtime {

/// Histogram with 1 us bins up to 4 ms, then 100 us bins up to 400 ms; larger values count in the
/// last bin. One thread writes. Any thread may read; it may miss the last few samples.
class LatencyHistogram {
 public:
  /// Real-time safe. Negative values count as 0.
  void record(std::int64_t latency_ns) noexcept;
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }
  double max_us() const noexcept {
    return static_cast<double>(max_ns_.load(std::memory_order_relaxed)) * 1e-3;
  }
  /// Upper edge of the bin that contains the quantile [us]; 0 without samples.
  double quantile_us(double q) const noexcept;

 private:
  static constexpr std::size_t kFine = 4000, kCoarse = 4000;
  std::array<std::atomic<std::uint32_t>, kFine + kCoarse> steps_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace voxtouch::runtime
