#pragma once
/// The newest rows of a loop in preallocated memory, and their transfer to another thread.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace voxtouch::faults {

/// A double buffer of rows. The loop writes one half as a ring. When it keeps that half, it
/// continues with the other until the kept one has been taken. One thread calls `reserve`, `push`
/// and `keep`, another `take`.
template <class Row>
class RecentRows {
  static_assert(std::is_trivially_copyable_v<Row>);

 public:
  /// Allocates two buffers of `rows` rows, both empty. Returns false, without effect, while kept
  /// rows wait to be taken. Not for the loop: allocates.
  bool reserve(std::size_t rows) {
    if (kept_.load(std::memory_order_acquire))
      return false;
    for (Half& half : halves_)
      half.rows.assign(rows, Row{}), half.added = 0;
    return true;
  }

  /// Real-time safe.
  void push(const Row& row) noexcept {
    Half& half = halves_[writing_];
    if (!half.rows.empty())
      half.rows[half.added++ % half.rows.size()] = row;
  }

  /// Keeps the current rows with this reason, which must have static lifetime. Returns false
  /// without rows, and while kept rows have not been taken. Also returns false if the reason equals
  /// the last one and some rows are older than it. Real-time safe.
  bool keep(const char* reason) noexcept {
    const Half& half = halves_[writing_];
    if (half.added == 0 || kept_.load(std::memory_order_acquire))
      return false;
    if (reason == reason_ && half.added < half.rows.size())
      return false;
    reason_ = reason;
    writing_ ^= 1U;
    halves_[writing_].added = 0;
    kept_.store(true, std::memory_order_release);
    return true;
  }

  /// Ratio of the memory filled with rows since the last keep, [0, 1]. Called by the loop;
  /// real-time safe.
  double fraction_new() const noexcept {
    const Half& half = halves_[writing_];
    return half.rows.empty() ? 0.0
                             : std::min(1.0, static_cast<double>(half.added) /
                                                 static_cast<double>(half.rows.size()));
  }

  /// Calls f(reason, rows), oldest row first, if rows are kept. Afterwards new rows may be kept.
  /// Allocates.
  template <class F>
  bool take(F&& f) {
    if (!kept_.load(std::memory_order_acquire))
      return false;
    const Half& half = halves_[writing_ ^ 1U];  // the loop does not switch halves while this one is
                                                // kept
    const std::size_t count = std::min(half.added, half.rows.size());
    std::vector<Row> rows;
    rows.reserve(count);
    for (std::size_t n = half.added - count; n < half.added; ++n)
      rows.push_back(half.rows[n % half.rows.size()]);
    f(reason_, static_cast<const std::vector<Row>&>(rows));
    kept_.store(false, std::memory_order_release);
    return true;
  }

 private:
  struct Half {
    std::vector<Row> rows;
    std::size_t added = 0;
  };
  std::array<Half, 2> halves_;
  std::size_t writing_ = 0;
  const char* reason_ = nullptr;  ///< reason of the last keep
  std::atomic<bool> kept_{false};
};

}  // namespace voxtouch::faults
