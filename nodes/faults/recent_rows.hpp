#pragma once
/// The newest rows of a loop, in memory taken beforehand, and a way to hand them to another thread.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace voxtouch::faults {

/// Two halves: the loop writes one over and over; when it keeps it, it goes on with the other until
/// the kept one has been taken. One thread calls `reserve`, `push` and `keep`, another one `take`.
template <class Row>
class RecentRows {
  static_assert(std::is_trivially_copyable_v<Row>);

 public:
  /// Memory for so many rows, twice, and nothing in it; false, and nothing done, while rows wait to
  /// be taken. Not for the loop: allocates.
  bool reserve(std::size_t rows) {
    if (kept_.load(std::memory_order_acquire))
      return false;
    for (Half& half : halves_)
      half.rows.assign(rows, Row{}), half.pushed = 0;
    return true;
  }

  /// Real-time safe.
  void push(const Row& row) noexcept {
    Half& half = halves_[writing_];
    if (!half.rows.empty())
      half.rows[half.pushed++ % half.rows.size()] = row;
  }

  /// Keeps what is there, for this reason: a text that lives as long as the program. False where
  /// there is nothing, where what was kept before has not been taken yet, or where the last reason
  /// holds on: it keeps anew once all rows are new. Real-time safe.
  bool keep(const char* reason) noexcept {
    const Half& half = halves_[writing_];
    if (half.pushed == 0 || kept_.load(std::memory_order_acquire))
      return false;
    if (reason == reason_ && half.pushed < half.rows.size())
      return false;
    reason_ = reason;
    writing_ ^= 1U;
    halves_[writing_].pushed = 0;
    kept_.store(true, std::memory_order_release);
    return true;
  }

  /// How much of the memory holds rows that came since the last were kept, [0, 1]. Of the loop's
  /// thread; real-time safe.
  double share_new() const noexcept {
    const Half& half = halves_[writing_];
    return half.rows.empty() ? 0.0
                             : std::min(1.0, static_cast<double>(half.pushed) /
                                                 static_cast<double>(half.rows.size()));
  }

  /// Calls f(reason, rows), oldest first, where something is kept; afterwards the next may be kept.
  /// Allocates.
  template <class F>
  bool take(F&& f) {
    if (!kept_.load(std::memory_order_acquire))
      return false;
    const Half& half = halves_[writing_ ^ 1U];  // the loop does not change over while this is kept
    const std::size_t count = std::min(half.pushed, half.rows.size());
    std::vector<Row> rows;
    rows.reserve(count);
    for (std::size_t n = half.pushed - count; n < half.pushed; ++n)
      rows.push_back(half.rows[n % half.rows.size()]);
    f(reason_, static_cast<const std::vector<Row>&>(rows));
    kept_.store(false, std::memory_order_release);
    return true;
  }

 private:
  struct Half {
    std::vector<Row> rows;
    std::size_t pushed = 0;
  };
  std::array<Half, 2> halves_;
  std::size_t writing_ = 0;
  const char* reason_ = nullptr;  ///< of what was kept last
  std::atomic<bool> kept_{false};
};

}  // namespace voxtouch::faults
