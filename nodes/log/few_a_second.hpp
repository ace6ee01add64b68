#pragma once
/// Of a stream of texts that nobody bounds, so many that a person can read.
#include <cstdint>
#include <mutex>

namespace voxtouch::log {

/// The first few of each second are said, the others counted; the count is told with the first text
/// of a later second. Any thread.
class FewASecond {
 public:
  struct Verdict {
    bool say = false;
    std::uint64_t left_out = 0;  ///< before this one, and not told of yet
  };
  explicit FewASecond(int most) noexcept : most_(most) {}

  /// `now_ns`: of a clock that never steps back.
  Verdict take(std::int64_t now_ns) noexcept {
    const std::lock_guard lock(mutex_);
    Verdict verdict;
    if (!begun_ || now_ns - begin_ns_ >= 1'000'000'000) {
      begun_ = true, begin_ns_ = now_ns, said_ = 0;
      verdict.left_out = left_out_, left_out_ = 0;
    }
    verdict.say = said_ < most_;
    if (verdict.say)
      ++said_;
    else
      ++left_out_;
    return verdict;
  }

 private:
  const int most_;
  std::mutex mutex_;
  bool begun_ = false;
  std::int64_t begin_ns_ = 0;
  int said_ = 0;
  std::uint64_t left_out_ = 0;
};

}  // namespace voxtouch::log
