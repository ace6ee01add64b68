#pragma once
/// The figures of a device file: what is usual for the two classes of devices, what stands for a
/// figure that no data sheet has, and what each does to the design. One table for the reader, for
/// its sentences and for the manual.
#include <optional>
#include <string>
#include <string_view>

namespace voxtouch::scene {

struct DeviceFigure {
  std::string_view key;       ///< as in the file; those of `rotation` have names of their own
  std::string_view pen, arm;  ///< usual for a stylus and for an arm, with the unit
  std::optional<double> pen_standard,
      arm_standard;         ///< what stands for one that is left out; empty: it must be there
  std::string_view effect;  ///< what it does to the design, a sentence
};

/// The row of `key`. Throws std::logic_error for a key that has none.
const DeviceFigure& device_figure(std::string_view key);

/// "rate_hz: 500 to 4000 Hz (stylus), 200 to 1000 Hz (arm). A higher rate ..." for a person who has
/// to find the figure.
std::string to_sentence(const DeviceFigure& figure);

}  // namespace voxtouch::scene
