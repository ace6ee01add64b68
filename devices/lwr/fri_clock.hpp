#pragma once
/// The device's time from sequence counts and the controller's stamps.
#include <cmath>
#include <cstdint>
#include <limits>

namespace voxtouch::lwr::fri {

/// The stamp on the wire is a float: after 2.3 hours its steps exceed a millisecond. Time is
/// therefore counted in periods, and the stamp only checks the count. In virtual time the stamp
/// takes precedence if the two differ by more than half a period plus the resolution of the float.
/// A pure function of its inputs, real-time safe.
class FriClock {
 public:
  FriClock(std::int64_t period_ns, bool stamps_lead) noexcept
      : period_ns_(period_ns),
        stamps_lead_(stamps_lead) {}

  /// Processes the newest measurement, `steps` periods after the previous one. Returns the elapsed
  /// time since then, > 0 (0 for the first).
  std::int64_t update(float stamp_s, std::uint64_t steps) noexcept {
    const double last_s = stamp_s_;
    stamp_s_ = stamp_s;
    if (!started_)
      return started_ = true, 0;
    std::int64_t elapsed_ns = static_cast<std::int64_t>(steps) * period_ns_;
    const double stamps_ns = (stamp_s_ - last_s) * 1e9;
    const double grain_ns =
        1e9 * (std::nextafter(std::abs(stamp_s), std::numeric_limits<float>::infinity()) -
               std::abs(stamp_s));
    if (std::abs(stamps_ns - static_cast<double>(elapsed_ns)) >
        0.5 * static_cast<double>(period_ns_) + grain_ns) {
      ++disagreements_;
      if (stamps_lead_ && stamps_ns > 0.0 && stamps_ns < 1e15)
        elapsed_ns = std::llround(stamps_ns);
    }
    time_ns_ += elapsed_ns;
    return elapsed_ns;
  }
  /// Sets the time of the newest measurement to zero.
  void zero() noexcept { time_ns_ = 0; }
  std::int64_t time_ns() const noexcept { return time_ns_; }
  std::uint64_t disagreements() const noexcept { return disagreements_; }

 private:
  std::int64_t period_ns_, time_ns_ = 0;
  bool stamps_lead_, started_ = false;
  double stamp_s_ = 0.0;
  std::uint64_t disagreements_ = 0;
};

}  // namespace voxtouch::lwr::fri
