#pragma once
/// Force and answers of the last second.
#include <cstdint>
#include <deque>

namespace voxtouch::device_node {

/// Fed by the monitor about every 20 ms. Allocates.
class LastSecond {
 public:
  /// `samples` and `answered` count since the start; `largest_n`: of the forces since the last
  /// look.
  void look(std::int64_t now_ns, std::uint64_t samples, std::uint64_t answered, double largest_n);
  /// Of the last second [N].
  double largest_force_n() const;
  /// Of the samples of the last second; 1 where there were none.
  double answered_ratio() const;

 private:
  struct Look {
    std::int64_t at_ns;
    std::uint64_t samples, answered;
    double largest_n;
  };
  std::deque<Look> looks_;  ///< the first is where the second begins: of it only the counts matter
};

}  // namespace voxtouch::device_node
