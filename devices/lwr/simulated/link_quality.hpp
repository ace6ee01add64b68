#pragma once
/// How well the remote side answers: what the controller's statistics say, and the quality it makes
/// of them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr_sim {

/// Counts one answer or miss a period. Quality rises through a run of answers in time and falls
/// through misses; one lost answer does not change it, two in a row make PERFECT to OK. Rising to
/// PERFECT forgives the misses before. Real-time safe.
class LinkQuality {
 public:
  static constexpr std::size_t kWindow = 100;
  /// This period's answer came in time, `latency_s` [s] after the measurement.
  void answered(double latency_s) noexcept;
  /// None did.
  void missed() noexcept;

  lwr::fri::Quality quality() const noexcept { return quality_; }
  /// Of the last 100 periods: answers per period, mean latency, latest less earliest, misses per
  /// period; all misses so far.
  lwr::fri::Statistics statistics() const noexcept;

 private:
  void push(bool in_time, double latency_s) noexcept;

  std::array<double, kWindow> latency_{};  // [s]; negative: missed
  std::array<bool, kWindow> was_missed_{};
  std::size_t count_ = 0, next_ = 0;
  int answered_run_ = 0, missed_run_ = 0, missed_in_window_ = 0;
  std::uint32_t misses_ = 0;
  lwr::fri::Quality quality_ = lwr::fri::Quality::kUnacceptable;  // no answer has come yet
};

}  // namespace voxtouch::lwr_sim
