#pragma once
/// How long the machine itself kept a thread from running: what a late sample is held against.
#include <atomic>
#include <cstdint>
#include <thread>

namespace voxtouch::attack {

/// A thread that wants to wake up every millisecond, with the priority that the nodes of the ring ask for where it is granted.
class Beat {
 public:
  Beat();
  ~Beat();
  /// Forgets what was; the longest delay is counted from here.
  void restart() noexcept { longest_ns_.store(0); }
  /// The longest time by which a wake-up was late [ns].
  std::int64_t longest_ns() const noexcept { return longest_ns_.load(); }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> longest_ns_{0};
  std::thread thread_;
};

std::int64_t monotonic_ns() noexcept;

}  // namespace voxtouch::attack
