#pragma once
/// Checks whether a scene can run on a device.
#include <string>
#include <string_view>
#include <vector>

#include "core/coupling/design/loop_parts.hpp"
#include "core/device_fit/scene_requirements.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// Messages; a scene with errors must not run on this device.
struct DeviceCheck {
  std::vector<std::string> errors, warnings;
  bool fits() const noexcept { return errors.empty(); }
};

/// The reason, with a remedy, if the scene needs torque and the device gives none; else empty.
std::string torque_not_displayed(const SceneRequirements& demand, bool gives_torque);

/// The reason, with the place in the scene, if the effect `external` can request more force than
/// the device gives; else empty.
std::string external_too_strong(const SceneRequirements& demand,
                                const scene::WorkspaceMapping& scales,
                                const coupling::design::DeviceModel& device);

/// Checks `scene.coupling`; for a designed coupling store the design's spec (spec_W) there first.
/// `stiffness_bound_n_per_m`: of all points that can push at once, since the loop is loaded by
/// their sum. `stiffest`: the setting that messages propose to reduce; empty: the stiffest of the
/// scene.
DeviceCheck check_device(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                         double stiffness_bound_n_per_m, std::string_view stiffest = {});

/// The message if the sum of the effects' damping exceeds half of the stability limit, with the
/// place of the largest; else empty. For translation and rotation the limit is
///
///   b < (pi/2) m / (lag + delay)
///
/// with the least mass (inertia) m and the delay from a sample to the middle of the period of its
/// force. `spec`: the running coupling.
std::string effects_damp_too_much(const SceneRequirements& demand,
                                  const scene::WorkspaceMapping& scales,
                                  const coupling::CouplingSpec& spec,
                                  const coupling::design::DeviceModel& device);

/// All checks of a scene on a device, at the start and for each later change. Returns the reason
/// and a remedy if effects or contact must not be displayed; else empty. `runs`: the coupling, or
/// null if it is not designed yet; then only the checks that do not depend on it apply.
/// `least_n_per_m`: least displayed stiffness of any contact in W: of one point, or the requested
/// one.
std::string force_not_displayed(const scene::Scene& scene, const coupling::CouplingSpec* runs,
                                const coupling::design::DeviceModel& device, double least_n_per_m,
                                const SceneRequirements& demand);

}  // namespace voxtouch::device_fit
