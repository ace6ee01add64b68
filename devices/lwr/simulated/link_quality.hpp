#pragma once
/// How well the remote side answers: what the controller's statistics say, and the quality it makes of them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr_sim {

/// The real controller's thresholds are not published: all of these are assumed, and for that reason can be set.
struct QualityRules {
  int ok_after = 10;          ///< answers in time in a row: OK
  int perfect_after = 20;     ///< likewise: PERFECT
  int misses_in_a_row = 5;    ///< that many are too many: UNACCEPTABLE
  int misses_in_window = 10;  ///< more than that of the last 100 are too many: BAD

  /// Throws std::runtime_error that names field and rule.
  void validate() const;
};

/// Counts one answer or miss a period. Quality rises through a run of answers in time and falls through misses; one lost answer
/// does not change it, two in a row make PERFECT to OK. Rising to PERFECT forgives the misses before. Real-time safe.
class LinkQuality {
 public:
  static constexpr std::size_t kWindow = 100;
  /// `rules` as `validate` accepts them. No answer has come yet: UNACCEPTABLE.
  explicit LinkQuality(const QualityRules& rules = {});

  /// This period's answer came in time, `latency_s` [s] after the measurement.
  void answered(double latency_s) noexcept;
  /// None did.
  void missed() noexcept;

  lwr::fri::Quality quality() const noexcept { return quality_; }
  /// Of the last 100 periods: answers per period, mean latency, latest less earliest, misses per period; all misses so far.
  lwr::fri::Statistics statistics() const noexcept;

 private:
  void push(bool in_time, double latency_s) noexcept;

  QualityRules rules_;
  std::array<double, kWindow> latency_{};  // [s]; negative: missed
  std::array<bool, kWindow> was_missed_{};
  std::size_t count_ = 0, next_ = 0;
  int answered_run_ = 0, missed_run_ = 0, missed_in_window_ = 0;
  std::uint32_t misses_ = 0;
  lwr::fri::Quality quality_ = lwr::fri::Quality::kUnacceptable;
};

}  // namespace voxtouch::lwr_sim
