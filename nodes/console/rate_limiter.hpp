#pragma once
/// Limits the rate of an unbounded stream of texts.
#include <cstdint>
#include <mutex>

namespace voxtouch::console {

/// The first few texts of each second are printed, the others counted. The first text of a later
/// second includes the count. Any thread.
class RateLimiter {
 public:
  struct Verdict {
    bool print = false;
    std::uint64_t skipped = 0;  ///< before this one, and not yet reported
  };
  explicit RateLimiter(int most) noexcept : most_(most) {}

  /// `now_ns`: of a clock that never steps back.
  Verdict take(std::int64_t now_ns) noexcept {
    const std::lock_guard lock(mutex_);
    Verdict verdict;
    if (!begun_ || now_ns - begin_ns_ >= 1'000'000'000) {
      begun_ = true, begin_ns_ = now_ns, printed_ = 0;
      verdict.skipped = skipped_, skipped_ = 0;
    }
    verdict.print = printed_ < most_;
    if (verdict.print)
      ++printed_;
    else
      ++skipped_;
    return verdict;
  }

 private:
  const int most_;
  std::mutex mutex_;
  bool begun_ = false;
  std::int64_t begin_ns_ = 0;
  int printed_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace voxtouch::console
