#pragma once
/// Numeric parameters that the driver reads and sets, and that tests read: type, count, unit.
#include <array>

#include "devices/phantom/simulated/device.hpp"

namespace voxtouch::hd_sim {

/// Type of a parameter read.
enum class Type { kNone, kInteger, kDouble };

struct Values {
  std::array<double, 16> value{};
  int count = 0;
};

/// Reads a parameter in the units of the interface. kInvalidEnum: unknown parameter;
/// kInvalidInputType: not readable as `type`. `mean_rate_hz`: measured rate of the servo loop.
phantom::hd::HDerror read_parameter(const Device& device, double mean_rate_hz,
                                    phantom::hd::HDenum name, Type type, Values& out) noexcept;

/// Number of doubles to set for this parameter; 0: it cannot be set.
int settable(phantom::hd::HDenum name) noexcept;
/// Sets it, in the units of the interface. Values that are not finite are refused and counted.
phantom::hd::HDerror write_parameter(Device& device, phantom::hd::HDenum name,
                                     const Values& in) noexcept;

/// The switch of a capability; null for an unknown one.
bool* capability(Limits& limits, phantom::hd::HDenum name) noexcept;

}  // namespace voxtouch::hd_sim
