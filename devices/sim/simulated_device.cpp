#include "devices/sim/simulated_device.hpp"

#include <cmath>
#include <utility>

#include "devices/limits.hpp"
#include "devices/operator/hand.hpp"

namespace voxtouch::sim {
namespace {

double substep_s(const DeviceDescription& d) { return 1.0 / (d.rate_hz * kSubsteps); }

}  // namespace

SimulatedDevice::SimulatedDevice(const SimParameters& p, const OperatorConfig& hand, Motion motion,
                                 std::uint64_t seed, bool is_led)
    : description_(p.description),
      period_ns_(std::llround(1e9 / p.description.rate_hz)),
      plant_(p, hand::checked_grip(hand), hand::checked_motion(std::move(motion))),
      encoder_(p.description.position_resolution_m, p.description.orientation_resolution_rad,
               p.velocity_filter_hz, 1.0 / p.description.rate_hz),
      force_path_(p.description, substep_s(p.description)),
      tremor_(hand.tremor_n, hand.tremor_bandwidth_hz, 1.0 / p.description.rate_hz, seed) {
  if (is_led)
    plant_.be_led(1.0 / p.description.rate_hz, p.description);
  encoder_.sample(plant_.pose());
}

devices::DeviceResult<devices::DeviceSample> SimulatedDevice::read(
    std::chrono::microseconds) noexcept {
  if (!std::exchange(answered_, false))
    advance({});
  return devices::DeviceSample{time_ns(), encoder_.pose(), encoder_.twist(),
                               plant_.buttons_at(1e-9 * static_cast<double>(time_ns())), true};
}

devices::DeviceResult<void> SimulatedDevice::write(const Wrench& command) noexcept {
  const devices::DeviceResult<void> verdict = devices::check_command(command, description_);
  advance(verdict ? command : Wrench{});
  answered_ = true;
  return verdict;
}

void SimulatedDevice::advance(const Wrench& command) noexcept {
  const double dt_s = substep_s(description_);
  const Vec3 tremor = tremor_.next();
  for (int i = 0; i < kSubsteps; ++i) {
    applied_ = force_path_.step(command);
    // From a counter, not summed up: no drift, and any run of the same length ends at the same
    // time.
    plant_.step(applied_, tremor, static_cast<double>(period_ * kSubsteps + i) * dt_s, dt_s);
  }
  ++period_;
  plant_.next_period(applied_);
  encoder_.sample(plant_.pose());
}

void SimulatedDevice::stop() noexcept {
  force_path_.clear();
  applied_ = {};
}

}  // namespace voxtouch::sim
