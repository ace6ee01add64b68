#pragma once
/// The coupling of a scene on a device: designed, or set by hand and checked.
#include <optional>
#include <string>

#include "core/coupling/design/designer.hpp"
#include "core/device_fit/scene_requirements.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/series_spring.hpp"
#include "core/scene/design_options.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// Why a coupling must not run.
struct Refusal {
  std::string error;     ///< of device, scene or effects, with the remedy
  std::string device{};  ///< of an infeasible design
  std::optional<coupling::design::Design> infeasible{};
  bool in_transition = false;  ///< only between the present and the requested values
  bool empty() const noexcept { return error.empty() && !infeasible; }
};

struct FittedCoupling {
  coupling::CouplingSpec spec;  ///< the coupling to run, in W
  coupling::design::Design
      design;             ///< at the hand: the design, or the evaluation of a coupling set by hand
  bool designed = false;  ///< false: set by hand in the scene
  Refusal impossible;     ///< not empty if no coupling can run with any effects
  Refusal refusal;        ///< not empty if it must not run with the present effects
};

/// `bounds`: stiffness of the scene's contact and effects in W; `demand`: their other requirements.
/// Deterministic. Takes milliseconds to tenths of a second: not for the loop. A device or scene
/// that no coupling fits gives a refusal.
FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const rendering::StiffnessBounds& bounds,
                            const SceneRequirements& demand);
/// The same with the effects of the scene file.
FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const coupling::design::ContactRange& translation,
                            const coupling::design::ContactRange& rotation);

/// Repeats the check of a fitted coupling for other effects or a changed device, without a new fit.
/// Takes microseconds.
Refusal judge_again(const FittedCoupling& fitted, const scene::Scene& scene,
                    const coupling::design::DeviceModel& device, double one_point_n_per_m,
                    const SceneRequirements& demand);

/// Stiffness [N/m] in W of a virtual tool's spring with this coupling: the capped stiffness,
/// limited to what the device can display, minus the stiffness of effects (up to half of the caps),
/// which would otherwise scale both at the moment of a contact. Rotation follows by the lever
/// (`bounds`, as fitted). 0: no spring, or none may be displayed.
double spring_n_per_m(const FittedCoupling& fitted, const scene::Scene& scene,
                      const coupling::design::DeviceModel& device,
                      const rendering::StiffnessBounds& bounds) noexcept;

/// The spring in W in series with a penalty contact with this coupling. With it the stiffest
/// contact of the scene displays the certified stiffness, and never more. `alone`: stiffness of the
/// contact without effects; up to half of the caps is reserved for effects. With a body, its grip
/// counts as the contact. Translation is rigid with a virtual tool, without caps, and if contact
/// and effects together are within the caps. Rotation is rigid on a device without torque. Effects
/// of position (guides, magnets, fields) that are stiffer than the reserved half have a separate
/// spring, so that no cap scales them or the contact.
rendering::Compliance series_spring(const FittedCoupling& fitted, const scene::Scene& scene,
                                    const coupling::design::DeviceModel& device,
                                    const rendering::StiffnessBounds& alone,
                                    const rendering::StiffnessBounds& bounds) noexcept;

}  // namespace voxtouch::device_fit
