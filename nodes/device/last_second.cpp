#include "nodes/device/last_second.hpp"

#include <algorithm>

namespace voxtouch::device_node {

void LastSecond::poll(std::int64_t now_ns, std::uint64_t samples, std::uint64_t answered,
                      double largest_n) {
  looks_.push_back({now_ns, samples, answered, largest_n});
  while (looks_.size() > 1 && now_ns - looks_[1].at_ns >= 1'000'000'000)
    looks_.pop_front();
}

double LastSecond::largest_force_n() const {
  double largest_n = 0.0;
  for (std::size_t n = 1; n < looks_.size(); ++n)
    largest_n = std::max(largest_n, looks_[n].largest_n);
  return largest_n;
}

double LastSecond::answered_ratio() const {
  if (looks_.empty() || looks_.back().samples == looks_.front().samples)
    return 1.0;
  // A sample may be answered after the second that it belongs to.
  return std::min(1.0, static_cast<double>(looks_.back().answered - looks_.front().answered) /
                           static_cast<double>(looks_.back().samples - looks_.front().samples));
}

}  // namespace voxtouch::device_node
