#pragma once
/// Latencies counted in fixed storage, so that the loop can record them.
#include <array>
#include <atomic>
#include <cstdint>

namespace voxtouch::runtime {

/// Histogram of 1 us steps up to 4 ms, then 100 us steps up to 400 ms; the rest counts as the
/// maximum. One writer; any thread may read meanwhile and gets a picture that is a few samples old.
class LatencyHistogram {
 public:
  /// Real-time safe. Below 0 counts as 0.
  void record(std::int64_t latency_ns) noexcept;
  std::uint64_t count() const noexcept { return count_.load(std::memory_order_relaxed); }
  double max_us() const noexcept {
    return static_cast<double>(max_ns_.load(std::memory_order_relaxed)) * 1e-3;
  }
  /// Upper edge of the step that holds the quantile [us]; 0 without samples.
  double quantile_us(double q) const noexcept;

 private:
  static constexpr std::size_t kFine = 4000, kCoarse = 4000;
  std::array<std::atomic<std::uint32_t>, kFine + kCoarse> steps_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace voxtouch::runtime
