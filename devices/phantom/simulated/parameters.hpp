#pragma once
/// What the driver reads and sets by a number, and what tests look at: type, count, unit.
#include <array>

#include "devices/phantom/simulated/device.hpp"

namespace voxtouch::hd_sim {

/// What a parameter is read as.
enum class Type { kNone, kInteger, kDouble };

struct Values {
  std::array<double, 16> value{};
  int count = 0;
};

/// Reads a parameter in the interface's units. kInvalidEnum: there is none; kInvalidInputType: not
/// as `type`. `mean_rate_hz` of the servo loop, which only it knows.
phantom::hd::HDerror read_parameter(const Device& device, double mean_rate_hz,
                                    phantom::hd::HDenum name, Type type, Values& out) noexcept;

/// How many doubles a set of this parameter takes; 0: it cannot be set.
int settable(phantom::hd::HDenum name) noexcept;
/// Sets it, from the interface's units. Values that are not finite are refused and counted.
phantom::hd::HDerror write_parameter(Device& device, phantom::hd::HDenum name,
                                     const Values& in) noexcept;

/// The switch of a capability; null: there is none.
bool* capability(Limits& limits, phantom::hd::HDenum name) noexcept;

}  // namespace voxtouch::hd_sim
