#pragma once
/// A slow press into a scene, worked out without a ring: the force that a hand gets at each depth.
#include <vector>

#include "core/device_fit/fit_coupling.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::test {

/// At the hand.
struct Pressed {
  double depth_m = 0.0;  ///< of the hand, from where it touches first
  double force_n =
      0.0;  ///< returned by the coupling when it has come to rest, within the device's limit

  bool operator==(const Pressed&) const = default;
};

/// The tool follows `motion` to its first touch, and from there goes straight on against the push
/// that it met, ten steps of 1 mm of the hand. At each the coupling runs until it rests, so its
/// damping has no part in it; effects have theirs. The scene's time goes on by one sample a frame,
/// so what moves stands nearly still. Empty where the motion touches nothing in its approach and
/// the 4 s behind it, where nothing may be displayed, and where the dynamic object moves by itself.
/// `built` forgets the samples that it had before. Some hundred frames of the scene; not for the
/// loop.
std::vector<Pressed> press(rendering::BuiltScene& built, const scene::Scene& scene,
                           const device_fit::FittedCoupling& fitted,
                           const coupling::design::DeviceModel& device, const Motion& motion);

}  // namespace voxtouch::test
