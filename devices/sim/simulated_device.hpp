#pragma once
/// A simulated device: plant, encoder, force path, and operator.
#include <cstdint>

#include "core/types/motion.hpp"
#include "devices/driver.hpp"
#include "devices/sim/encoder.hpp"
#include "devices/sim/force_path.hpp"
#include "devices/sim/parameters.hpp"
#include "devices/sim/plant.hpp"
#include "devices/sim/tremor.hpp"

namespace voxtouch::sim {

/// Each `write` advances time by one period (eight substeps); the first sample is at time 0. A
/// `read` after a `read` first advances one period without force, as without a reply. A refused
/// command also takes its period, at zero force. No clock: the same calls give bit-identical
/// results.
class SimulatedDevice final : public devices::Driver {
 public:
  /// `motion`: target of the tool in D; the tool starts there at rest. `hand` replaces that of the
  /// parameters. `is_led`: the hand follows `lead_hand` instead, and rests at the motion's start
  /// before. Throws std::runtime_error for an invalid hand or motion.
  SimulatedDevice(const SimParameters& parameters, const OperatorConfig& hand, Motion motion,
                  std::uint64_t seed = 0, bool is_led = false);

  const DeviceDescription& description() const noexcept override { return description_; }
  devices::DeviceResult<devices::DeviceSample> read(
      std::chrono::microseconds timeout) noexcept override;
  devices::DeviceResult<void> write(const Wrench& command) noexcept override;
  void stop() noexcept override;
  bool simulated() const noexcept override { return true; }
  void lead_hand(const Pose& target) noexcept override { plant_.lead(target); }

  /// For tests: the state before the encoder, and the wrench of the motors in the last substep.
  const SimPlant& plant() const noexcept { return plant_; }
  const Wrench& applied() const noexcept { return applied_; }
  std::int64_t time_ns() const noexcept { return period_ * period_ns_; }

 private:
  void advance(const Wrench& command) noexcept;

  DeviceDescription description_;
  std::int64_t period_ns_, period_ = 0;  // period_: how many have passed
  SimPlant plant_;
  Encoder encoder_;
  ForcePath force_path_;
  Tremor tremor_;
  Wrench applied_;
  bool answered_ = true;  // a write, or the start, since the last read
};

}  // namespace voxtouch::sim
