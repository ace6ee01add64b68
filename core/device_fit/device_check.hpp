#pragma once
/// Does the scene fit the device? Asked where the device is known, which the scene file is not.
#include <string>
#include <string_view>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/device_fit/scene_requirements.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// Sentences for people; a scene with errors must not run on this device.
struct DeviceCheck {
  std::vector<std::string> errors, warnings;
  bool fits() const noexcept { return errors.empty(); }
};

/// Why a device that gives no torque cannot show what is demanded, a sentence with what to do.
/// Empty: it can.
std::string torque_not_displayed(const SceneRequirements& demand, bool gives_torque);

/// Why a device does not give what an effect may ask for that follows a program outside the ring, a
/// sentence with its place. Empty: it does, or there is no such effect.
std::string external_too_strong(const SceneRequirements& demand,
                                const scene::WorkspaceMapping& scales,
                                const coupling::design::DeviceModel& device);

/// Judges `scene.coupling` as it is: for a designed coupling put the design's spec (spec_W) there
/// first. `stiffness_bound_n_per_m`: of all points that can push at once, not of one: the total is
/// what the loop must stand. `stiffest`: what the sentence says to lower; empty: the stiffest of
/// the scene as it was read.
DeviceCheck check_device(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                         double stiffness_bound_n_per_m, std::string_view stiffest = {});

/// Where the effects' dampings together are more than half of what the device can stand, b < (pi/2)
/// m / (lag + delay), or the same of its rotation: a sentence with the place of the largest. m is
/// the least mass (inertia), the delay that from a sample to the middle of the period for which its
/// force is held. `spec`: the coupling that runs. Empty: they may be displayed.
std::string effects_damp_too_much(const SceneRequirements& demand,
                                  const scene::WorkspaceMapping& scales,
                                  const coupling::CouplingSpec& spec,
                                  const coupling::design::DeviceModel& device);

/// The judgement of a scene on a device, at the start and for each later change: a sentence why its
/// effects and contact must not be displayed, with what to do; empty: they may. `runs`: the
/// coupling, null where it will be designed and is not known yet (then only what does not depend on
/// it is judged). `least_n_per_m`: in W, that any contact shows at least: of one point, or what is
/// demanded.
std::string force_not_displayed(const scene::Scene& scene, const coupling::CouplingSpec* runs,
                                const coupling::design::DeviceModel& device, double least_n_per_m,
                                const SceneRequirements& demand);

}  // namespace voxtouch::device_fit
