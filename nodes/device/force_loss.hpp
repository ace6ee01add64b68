#pragma once
/// Measures how long force was lost: its commands stopped or the process was suspended. A pure
/// function of its inputs; real-time safe.
#include <algorithm>
#include <cstdint>

namespace voxtouch::device_node {

/// A loss begins if the guard reduces commands more than in the last cycle, and the device had a
/// force. It lasts until the guard passes commands unreduced.
class ForceLoss {
 public:
  /// Call once per cycle. `fraction`: of a command that the guard passes, 1 if unreduced.
  /// `force_n`: force of the device [N].
  void note(std::int64_t now_ns, double fraction, double force_n) noexcept {
    if (!lost_ && fraction < fraction_ && force_n_ > 0.0)
      lost_ = true, ++count_;
    if (lost_ && fraction >= 1.0) {
      longest_ns_ = std::max(longest_ns_, now_ns - since_ns_), past_ns_ += now_ns - since_ns_;
      lost_ = false;
    }
    if (!lost_)
      since_ns_ = now_ns;
    now_ns_ = now_ns, fraction_ = fraction, force_n_ = force_n;
  }
  std::uint64_t count() const noexcept { return count_; }
  std::int64_t total_ns() const noexcept { return past_ns_ + open_ns(); }
  std::int64_t longest_ns() const noexcept { return std::max(longest_ns_, open_ns()); }

 private:
  std::int64_t open_ns() const noexcept { return lost_ ? now_ns_ - since_ns_ : 0; }
  std::uint64_t count_ = 0;
  std::int64_t since_ns_ = 0, now_ns_ = 0, past_ns_ = 0, longest_ns_ = 0;
  double fraction_ = 0.0, force_n_ = 0.0;
  bool lost_ = false;
};

}  // namespace voxtouch::device_node
