#include "nodes/device/last_second.hpp"

#include <algorithm>

namespace voxtouch::device_node {

void LastSecond::poll(std::int64_t now_ns, std::uint64_t samples, std::uint64_t answered,
                      double largest_n) {
  polls_.push_back({now_ns, samples, answered, largest_n});
  while (polls_.size() > 1 && now_ns - polls_[1].at_ns >= 1'000'000'000)
    polls_.pop_front();
}

double LastSecond::largest_force_n() const {
  double largest_n = 0.0;
  for (std::size_t n = 1; n < polls_.size(); ++n)
    largest_n = std::max(largest_n, polls_[n].largest_n);
  return largest_n;
}

double LastSecond::answered_ratio() const {
  if (polls_.empty() || polls_.back().samples == polls_.front().samples)
    return 1.0;
  // A sample may be answered after the second that it belongs to.
  return std::min(1.0, static_cast<double>(polls_.back().answered - polls_.front().answered) /
                           static_cast<double>(polls_.back().samples - polls_.front().samples));
}

}  // namespace voxtouch::device_node
