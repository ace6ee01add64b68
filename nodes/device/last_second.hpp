#pragma once
/// Largest force and ratio of answered samples in the last second.
#include <cstdint>
#include <deque>

namespace voxtouch::device_node {

/// Updated by the monitor about every 20 ms. Allocates.
class LastSecond {
 public:
  /// `samples` and `answered` count from the start. `largest_n`: largest force since the last call
  /// [N].
  void poll(std::int64_t now_ns, std::uint64_t samples, std::uint64_t answered, double largest_n);
  /// Largest force of the last second [N].
  double largest_force_n() const;
  /// Ratio of answered samples in the last second; 1 without samples.
  double answered_ratio() const;

 private:
  struct Poll {
    std::int64_t at_ns;
    std::uint64_t samples, answered;
    double largest_n;
  };
  /// The first entry marks the start of the second; only its counts are used.
  std::deque<Poll> polls_;
};

}  // namespace voxtouch::device_node
