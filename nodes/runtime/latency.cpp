#include "nodes/runtime/latency.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::runtime {

void LatencyHistogram::record(std::int64_t latency_ns) noexcept {
  const std::int64_t us = std::max<std::int64_t>(latency_ns, 0) / 1000;
  const std::size_t step = us < static_cast<std::int64_t>(kFine)
                               ? static_cast<std::size_t>(us)
                               : kFine + static_cast<std::size_t>(us / 100);
  steps_[std::min(step, steps_.size() - 1)].fetch_add(1, std::memory_order_relaxed);
  count_.fetch_add(1, std::memory_order_relaxed);
  if (latency_ns > max_ns_.load(std::memory_order_relaxed))
    max_ns_.store(latency_ns, std::memory_order_relaxed);
}

double LatencyHistogram::quantile_us(double q) const noexcept {
  if (count() == 0)
    return 0.0;
  const auto requested = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count())));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < steps_.size(); ++i)
    if ((seen += steps_[i].load(std::memory_order_relaxed)) >= requested) {
      const double edge =
          i < kFine ? static_cast<double>(i + 1) : static_cast<double>(i - kFine + 1) * 100.0;
      return std::min(edge, max_us());
    }
  return max_us();
}

}  // namespace voxtouch::runtime
