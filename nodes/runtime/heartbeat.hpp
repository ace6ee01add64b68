#pragma once
/// Signs of life of loops and of nodes.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>

#include "nodes/runtime/clock.hpp"

namespace voxtouch::runtime {

/// Statuses come ten times a second and loops cycle at least every 50 ms: one without a sign for
/// this long hangs [ns].
inline constexpr std::int64_t kHungNs = 400'000'000;
/// A peer silent for this long ends a lockstep run, and `up` [ns].
inline constexpr std::int64_t kGivenUpNs = 5'000'000'000;

/// Time that stands still while its owner does not look, so that a stalled watcher takes no other
/// for hung.
class WatchClock {
 public:
  /// Call at each look, at least every 20 ms or so, before what has come since is noted.
  void look(std::int64_t now_ns) noexcept {
    const std::int64_t gap_ns = last_look_ns_ ? now_ns - *last_look_ns_ : 0;
    last_look_ns_ = now_ns;
    watched_ns_ += std::min(gap_ns, kLateNs);
  }
  /// Time spent watching [ns].
  std::int64_t now_ns() const noexcept { return watched_ns_; }

 private:
  static constexpr std::int64_t kLateNs = 100'000'000;
  std::optional<std::int64_t> last_look_ns_;
  std::int64_t watched_ns_ = 0;
};

/// Of a loop. Real-time safe.
class Heartbeat {
 public:
  void beat() noexcept { beats_.fetch_add(1, std::memory_order_relaxed); }
  /// Changes while the loop goes on, or is busy.
  std::uint64_t sign() const noexcept {
    const std::int64_t now_ns = monotonic_ns();
    const bool busy = now_ns < busy_until_ns_.load(std::memory_order_relaxed);
    return beats_.load(std::memory_order_relaxed) +
           (busy ? static_cast<std::uint64_t>(now_ns) : 0U);
  }

  /// A pass of the loop that may take long, `most_ns` at most.
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

/// For how long a sign has not changed.
class StallWatch {
 public:
  /// By the watcher's clock [ns].
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
