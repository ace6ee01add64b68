#pragma once
/// Everything that can be read and set by a number: its type, count, unit.
#include <array>

#include "devices/phantom/simulated/device.hpp"

namespace voxtouch::hd_sim {

/// Types that a parameter may be read or set as.
enum Type : unsigned { kBoolean = 1, kInteger = 2, kFloat = 4, kDouble = 8, kLong = 16, kReal = kFloat | kDouble };

struct Values {
  std::array<double, 16> value{};
  int count = 0;
};

/// Rates of the servo loop, which only it knows [Hz].
struct Rates {
  double mean_hz = 0.0, last_hz = 0.0;
};

/// Reads a parameter in the interface's units. kInvalidEnum: there is none; kInvalidInputType: not as `type`.
phantom::hd::HDerror read_parameter(const Device& device, const Rates& rates, phantom::hd::HDenum name, Type type, Values& out) noexcept;

/// How many values a set of this parameter takes, and whether it may be set as `type`.
phantom::hd::HDerror settable(phantom::hd::HDenum name, Type type, int& count) noexcept;
/// Sets it, from the interface's units. Values that are not finite are refused and counted.
phantom::hd::HDerror write_parameter(Device& device, phantom::hd::HDenum name, const Values& in) noexcept;

/// Null: no string of that name.
phantom::hd::HDstring read_string(const Model& model, phantom::hd::HDenum name) noexcept;

/// The switch of a capability; null: there is none.
bool* capability(Limits& limits, phantom::hd::HDenum name) noexcept;

}  // namespace voxtouch::hd_sim
