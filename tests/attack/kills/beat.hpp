#pragma once
/// Measures how long the machine itself keeps threads from running, for comparison with late
/// samples.
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace voxtouch::attack {

/// One thread per CPU that wakes up every millisecond, with the priority of the ring's nodes if
/// permitted. On a virtual machine one CPU may be suspended while the others run.
class Beats {
 public:
  Beats();
  ~Beats();
  /// Resets the longest delay.
  void restart() noexcept;
  /// The longest time by which a wake-up on any CPU was late [ns].
  std::int64_t longest_ns() const noexcept;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::atomic<std::int64_t>> longest_ns_;
  std::vector<std::thread> threads_;
};

/// The clock with which DDS stamps samples.
std::int64_t unix_ns() noexcept;

}  // namespace voxtouch::attack
