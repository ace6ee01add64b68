#pragma once
/// Options for opening a device by its name.
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

/// KEY and VALUE of --device-option, in order. deploy/devices has a page with the keys of each
/// device.
using DeviceSettings = std::vector<std::pair<std::string, std::string>>;

struct DeviceOptions {
  std::uint64_t seed = 0;        ///< of a simulated hand's tremor, and of an emulator's noise
  std::optional<Motion> motion;  ///< target of a simulated hand in D; unset: it stays at the origin
  std::optional<sim::OperatorConfig> hand;  ///< unset: usual_hand(name)
  /// The simulated hand follows Driver::lead_hand instead of `motion`, from the start of `motion`
  /// on; requires can_be_led(name).
  bool is_led = false;
  bool lockstep = false;  ///< an emulator runs in virtual time; hardware cannot
  DeviceSettings settings;
  std::optional<DeviceDescription> described;  ///< of `sim:FILE`; the caller reads the file
  /// Another thread sets it to cancel opening, which then throws DeviceOpenError. Null: never.
  const std::atomic<bool>* cancelled = nullptr;
};

/// The requested motion of the hand, or rest at the origin of D.
inline Motion motion_of(const DeviceOptions& options) {
  Motion rest;
  rest.path = {Vec3::Zero()};
  return options.motion.value_or(rest);
}

/// Default position of the rest pose in D: the centre of x -0.09..0.03, y -0.09..0, z 0..0.13 m.
/// The motions of the shipped scenes use this volume, and both a Phantom on a desk and an arm at
/// its rest posture reach it.
inline Vec3 usual_rest_in_d() { return {-0.03, -0.045, 0.065}; }

}  // namespace voxtouch::devices
