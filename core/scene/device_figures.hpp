#pragma once
/// The figures of a device file: usual ranges for the two classes of devices, defaults for figures
/// without a data sheet, and the effect of each on the design. One table for the reader, for
/// messages and for the manual.
#include <optional>
#include <string>
#include <string_view>

namespace voxtouch::scene {

struct DeviceFigure {
  std::string_view key;       ///< as in the file; those of `rotation` have different names
  std::string_view pen, arm;  ///< usual for a stylus and for an arm, with the unit
  std::optional<double> pen_standard,
      arm_standard;         ///< default if it is omitted; empty: required
  std::string_view effect;  ///< its effect on the design, a sentence
};

/// The row of `key`. Throws std::logic_error for a key that has none.
const DeviceFigure& device_figure(std::string_view key);

/// "rate_hz: 500 to 4000 Hz (stylus), 200 to 1000 Hz (arm). A higher rate ...", for a missing
/// figure.
std::string to_sentence(const DeviceFigure& figure);

}  // namespace voxtouch::scene
