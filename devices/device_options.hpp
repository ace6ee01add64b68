#pragma once
/// What opening a device by its name may need.
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/device_description.hpp"
#include "core/types/motion.hpp"
#include "devices/sim/operator.hpp"

namespace voxtouch::devices {

/// KEY and VALUE as typed, in their order. The keys of a device are on its page of
/// deploy/devices.
using DeviceSettings = std::vector<std::pair<std::string, std::string>>;

struct DeviceOptions {
  std::uint64_t seed = 0;  ///< of a simulated hand's tremor, and of an emulator's noise
  std::optional<Motion>
      motion;  ///< where a simulated hand goes, in D; absent: it stays at the origin
  std::optional<sim::OperatorConfig> hand;  ///< absent: the usual grip, usual_hand(name)
  /// The simulated hand follows Driver::lead_hand instead of `motion`, at whose start it begins;
  /// only where can_be_led(name).
  bool is_led = false;
  bool lockstep = false;  ///< an emulator runs in virtual time; hardware cannot
  DeviceSettings settings;
  std::optional<DeviceDescription>
      described;  ///< of `sim:FILE`, whose file the caller has read: drivers read none
  /// Set by another thread when whoever opens the device no longer wants it: opening then ends with
  /// DeviceOpenError. Null: never.
  const std::atomic<bool>* cancelled = nullptr;
};

/// The hand's motion: the one asked for, or rest at the origin of D.
inline Motion motion_of(const DeviceOptions& options) {
  Motion rest;
  rest.path = {Vec3::Zero()};
  return options.motion.value_or(rest);
}

/// Where a device's own rest pose lies in D unless it is set otherwise: in the middle of x
/// -0.09..0.03, y -0.09..0, z 0..0.13 m, the volume that the shipped scenes' motions fill, so that
/// a Phantom on a desk and an arm at its rest posture both reach all of it.
inline Vec3 usual_rest_in_d() { return {-0.03, -0.045, 0.065}; }

}  // namespace voxtouch::devices
