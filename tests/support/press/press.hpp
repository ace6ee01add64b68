#pragma once
/// A slow press into a scene, worked out without a ring: the force that a hand gets at each depth.
#include <vector>

#include "core/device_fit/fit_coupling.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::test {

/// At the hand.
struct Pressed {
  double depth_m = 0.0;  ///< of the hand, from the first touch
  double force_n = 0.0;  ///< returned by the coupling at rest, within the device's limit

  bool operator==(const Pressed&) const = default;
};

/// The tool follows `motion` to its first touch, and then moves straight on against the force
/// there, ten steps of 1 mm of the hand. At each the coupling runs until it rests, so its damping
/// has no influence; that of effects has. The scene's time advances by one sample per frame, so
/// moving objects are nearly at rest. Empty if the motion touches nothing in its approach and 4 s
/// after it, if nothing may be displayed, and if the dynamic object is a free body. Resets `built`.
/// Some hundred frames of the scene; not for the loop.
std::vector<Pressed> press(rendering::BuiltScene& built, const scene::Scene& scene,
                           const device_fit::FittedCoupling& fitted,
                           const coupling::design::DeviceModel& device, const Motion& motion);

}  // namespace voxtouch::test
