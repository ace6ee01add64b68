#pragma once
/// Figures that a loop counts and a monitor publishes.
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "nodes/runtime/figure.hpp"

namespace voxtouch::runtime {

enum class Counting : std::uint8_t {
  kSum,
  kMaximum,
  kLast,
  kFirst,  ///< not published until it has a value
};

/// A row of a node's table. The rows are in the order of their enumerators.
template <class Name>
struct CounterRow {
  Name counter;
  const char* name;  ///< empty: not published
  const char* unit;
  Counting counting = Counting::kSum;
};

/// The counters of a table. Each counter has one writing thread; any thread may read it.
template <const auto& kTable>
class Counters {
 public:
  using Name = std::remove_const_t<decltype(kTable[0].counter)>;

  Counters() noexcept {
    for (const auto& row : kTable)
      cell(row.counter) = row.counting == Counting::kFirst ? std::nan("") : 0.0;
  }

  /// Adds, raises or sets, according to the row of the counter. Real-time safe.
  void note(Name counter, double value = 1.0) noexcept {
    const double now = (*this)[counter];
    const Counting counting = kTable[index(counter)].counting;
    if (counting == Counting::kMaximum && !(value > now))
      return;
    if (counting == Counting::kFirst && !std::isnan(now))
      return;
    cell(counter).store(counting == Counting::kSum ? now + value : value, kRelaxed);
  }
  /// NaN while there is no value. Real-time safe.
  double operator[](Name counter) const noexcept { return cells_[index(counter)].load(kRelaxed); }
  /// Returns the value and resets it to 0. Real-time safe.
  double take(Name counter) noexcept { return cell(counter).exchange(0.0, kRelaxed); }

  /// Reports the first `count` rows of the table. Allocates.
  void report_to(Figures& figures, std::size_t count = kTable.size()) const {
    for (const auto& row : std::span(kTable).first(count))
      if (const double value = (*this)[row.counter]; *row.name && !std::isnan(value))
        figures[row.name] = {value, row.unit};
  }
  /// Number of rows up to and including `counter`.
  static constexpr std::size_t through(Name counter) noexcept { return index(counter) + 1; }

 private:
  static constexpr auto kRelaxed = std::memory_order_relaxed;
  static constexpr std::size_t index(Name counter) noexcept {
    return static_cast<std::size_t>(counter);
  }
  static constexpr bool is_in_order() {
    for (std::size_t n = 0; n < kTable.size(); ++n)
      if (index(kTable[n].counter) != n)
        return false;
    return true;
  }
  static_assert(is_in_order() && std::atomic<double>::is_always_lock_free);
  std::atomic<double>& cell(Name counter) noexcept { return cells_[index(counter)]; }

  std::array<std::atomic<double>, kTable.size()> cells_;
};

}  // namespace voxtouch::runtime
