#pragma once
/// The work of a frame, counted and never clocked: the same frames cost the same work on any
/// machine.
#include <cstdint>
#include <limits>

namespace voxtouch::exact {

/// One unit is about one box test (some 10 ns on a processor of 2020). Real-time safe.
class Work {
 public:
  /// Default limit of a frame.
  static constexpr std::uint64_t kOfFrame = 45000;
  static constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
  /// Units of a pair's exact distance, of its rows, of its swept test, of a projection's look at 16
  /// rows, and of a row that comes or goes.
  static constexpr std::uint64_t kPair = 4, kTouches = 5, kSwept = 12, kRows16 = 4, kRowChange = 20;

  explicit Work(std::uint64_t limit = kNoLimit) noexcept : limit_(limit) {}
  void add(std::uint64_t units) noexcept { used_ += units; }
  std::uint64_t used() const noexcept { return used_; }
  /// Until the next call, `done` refers to this limit.
  void set_limit(std::uint64_t limit) noexcept { limit_ = limit; }
  bool done() const noexcept { return used_ >= limit_; }

 private:
  std::uint64_t used_ = 0, limit_;
};

}  // namespace voxtouch::exact
