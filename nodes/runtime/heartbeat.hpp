#pragma once
/// Detects loops and nodes that hang.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>

#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {

/// Nodes publish their status ten times a second and loops cycle at least every 50 ms. After this
/// time without a sign of life they are reported as hung [ns].
inline constexpr std::int64_t kHungNs = 400'000'000;
/// After this time without a sign of life from a peer, a lockstep run and `up` end [ns].
inline constexpr std::int64_t kGivenUpNs = 5'000'000'000;

/// A clock that stops while its owner does not update it, so that a stalled watcher reports no
/// other node as hung.
class WatchClock {
 public:
  /// Call at least every 20 ms, and first in each poll; then note new signs of life.
  void poll(std::int64_t now_ns) noexcept {
    const std::int64_t gap_ns = last_poll_ns_ ? now_ns - *last_poll_ns_ : 0;
    last_poll_ns_ = now_ns;
    watched_ns_ += std::min(gap_ns, kLateNs);
  }
  /// Time spent watching [ns].
  std::int64_t now_ns() const noexcept { return watched_ns_; }

 private:
  static constexpr std::int64_t kLateNs = 100'000'000;
  std::optional<std::int64_t> last_poll_ns_;
  std::int64_t watched_ns_ = 0;
};

/// Counts the cycles of a loop. Real-time safe.
class Heartbeat {
 public:
  void beat() noexcept { beats_.fetch_add(1, std::memory_order_relaxed); }
  /// Changes while the loop cycles or is marked busy.
  std::uint64_t sign() const noexcept {
    const std::int64_t now_ns = monotonic_ns();
    const bool busy = now_ns < busy_until_ns_.load(std::memory_order_relaxed);
    return beats_.load(std::memory_order_relaxed) +
           (busy ? static_cast<std::uint64_t>(now_ns) : 0U);
  }

  /// Marks a pass of the loop that may take up to `most_ns`.
  class Busy {
   public:
    Busy(Heartbeat& loop, std::int64_t most_ns) noexcept : loop_(loop) {
      loop_.busy_until_ns_.store(monotonic_ns() + most_ns, std::memory_order_relaxed);
    }
    ~Busy() {
      loop_.beat();
      loop_.busy_until_ns_.store(0, std::memory_order_relaxed);
    }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

   private:
    Heartbeat& loop_;
  };

 private:
  std::atomic<std::uint64_t> beats_{0};
  std::atomic<std::int64_t> busy_until_ns_{0};
};

/// Measures for how long a sign of life has not changed.
class StallWatch {
 public:
  /// Duration by the watcher's clock [ns].
  std::int64_t stalled_ns(std::uint64_t sign, const WatchClock& clock) noexcept {
    if (sign_ != sign)
      sign_ = sign, since_ns_ = clock.now_ns();
    return clock.now_ns() - since_ns_;
  }

 private:
  std::optional<std::uint64_t> sign_;
  std::int64_t since_ns_ = 0;
};

}  // namespace voxtouch::runtime
