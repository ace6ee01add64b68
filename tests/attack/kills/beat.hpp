#pragma once
/// How long the machine itself kept threads from running: what a late sample is compared with.
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

namespace voxtouch::attack {

/// On each CPU a thread that wants to wake up every millisecond, with the priority that the nodes
/// of the ring ask for where it is granted: of a virtual machine one CPU may stand still while the
/// others run.
class Beats {
 public:
  Beats();
  ~Beats();
  /// Forgets what was; the longest delay is counted from here.
  void restart() noexcept;
  /// The longest time by which a wake-up on any CPU was late [ns].
  std::int64_t longest_ns() const noexcept;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::atomic<std::int64_t>> longest_ns_;
  std::vector<std::thread> threads_;
};

/// The clock by which DDS stamps what is written.
std::int64_t unix_ns() noexcept;

}  // namespace voxtouch::attack
