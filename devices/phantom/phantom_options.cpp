#include "devices/phantom/phantom_options.hpp"

#include <fmt/format.h>

#include <string_view>

#include "devices/driver.hpp"

namespace voxtouch::phantom {
namespace {

void require_in(double value, double low, double high, std::string_view field) {
  if (!(value >= low && value <= high))
    throw devices::DeviceOpenError(
        fmt::format("device 'phantom': option {} is {}, but has to be in [{}, {}]", field, value, low, high));
}

}  // namespace

void PhantomOptions::validate() const {
  for (int axis = 0; axis < 3; ++axis) require_in(origin_in_d[axis], -10.0, 10.0, "origin_in_d");
  if (rate_hz) require_in(*rate_hz, 100.0, 10000.0, "rate_hz");
  if (max_force_n) require_in(*max_force_n, 1e-3, 1e3, "max_force_n");
  if (max_speed_m_per_s) require_in(*max_speed_m_per_s, 1e-3, 100.0, "max_speed_m_per_s");
  require_in(calibration_timeout_s, 0.0, 3600.0, "calibration_timeout_s");
  require_in(velocity_cutoff_hz, 0.1, 1000.0, "velocity_cutoff_hz");
  require_in(silence_s, 0.01, 60.0, "silence_s");
}

}  // namespace voxtouch::phantom
