#pragma once
/// The samples and commands of one axis, in storage that is reserved before the run.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace voxtouch::identification {

/// Parts of a run; windows of the fit are cut from strokes and pulses.
enum class Part : std::uint8_t { kHold, kBreakAway, kPulse, kProbeStroke, kStroke, kDenseTones };

/// Forces and positions of the other two axes, which act on this axis.
struct CrossAxis {
  std::array<double, 2> force_n{}, position_m{};
};

struct RecordEntry {
  double time_s = 0.0;
  double position_m = 0.0;
  double force_n = 0.0;       ///< the force sent in reply to this sample
  std::int16_t segment = 0;   ///< grows with each stroke, pulse and ramp
  std::int8_t direction = 0;  ///< of the reference
  Part part = Part::kHold;
  CrossAxis cross_axis{};
};

/// Real-time safe after `reserve`: entries beyond the capacity are dropped.
class AxisRecord {
 public:
  void reserve(std::size_t entries) {
    entries_.reserve(entries);
    entries_.clear();
  }
  void add(const RecordEntry& entry) noexcept {
    if (entries_.size() < entries_.capacity())
      entries_.push_back(entry);
  }
  /// The force sent in reply to the last sample, after the guard.
  void set_last(double force_n, const CrossAxis& cross_axis) noexcept {
    if (entries_.empty())
      return;
    entries_.back().force_n = force_n;
    entries_.back().cross_axis = cross_axis;
  }
  const std::vector<RecordEntry>& entries() const noexcept { return entries_; }
  bool full() const noexcept { return entries_.size() >= entries_.capacity(); }

 private:
  std::vector<RecordEntry> entries_;
};

}  // namespace voxtouch::identification
