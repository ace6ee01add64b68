#pragma once
/// Quality of the remote side's replies: the statistics of the controller, and the quality derived
/// from them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr_sim {

/// Counts one reply or miss per period. Quality rises by a run of replies in time and falls by
/// misses. A single lost reply does not change it; two consecutive ones reduce PERFECT to OK.
/// Rising to PERFECT clears the earlier misses. Real-time safe.
class LinkQuality {
 public:
  static constexpr std::size_t kWindow = 100;
  /// The reply of this period arrived in time, `latency_s` [s] after the measurement.
  void answered(double latency_s) noexcept;
  /// This period had no reply.
  void missed() noexcept;

  lwr::fri::Quality quality() const noexcept { return quality_; }
  /// Over the last 100 periods: replies per period, mean latency, latest minus earliest, misses per
  /// period; and all misses so far.
  lwr::fri::Statistics statistics() const noexcept;

 private:
  void push(bool in_time, double latency_s) noexcept;

  std::array<double, kWindow> latency_{};  // [s]; negative: missed
  std::array<bool, kWindow> was_missed_{};
  std::size_t count_ = 0, next_ = 0;
  int answered_run_ = 0, missed_run_ = 0, missed_in_window_ = 0;
  std::uint32_t misses_ = 0;
  lwr::fri::Quality quality_ = lwr::fri::Quality::kUnacceptable;  // no reply yet
};

}  // namespace voxtouch::lwr_sim
