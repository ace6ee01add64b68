#pragma once
/// The coupling of a scene on a device: designed, or set by hand and checked.
#include <string>

#include "core/coupling/design/designer.hpp"
#include "core/device_fit/scene_requirements.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/series_spring.hpp"
#include "core/scene/design_options.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

struct FittedCoupling {
  coupling::CouplingSpec spec;  ///< the coupling to run, in W
  coupling::design::Design
      design;              ///< at the hand: the design, or the evaluation of a coupling set by hand
  bool designed = false;   ///< false: set by hand in the scene
  std::string impossible;  ///< the reason if no coupling can run with any effects; else empty
  std::string refusal;     ///< the reason and remedy if it must not run with the present effects;
                           ///< else empty
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
std::string judge_again(const FittedCoupling& fitted, const scene::Scene& scene,
                        const coupling::design::DeviceModel& device, double one_point_n_per_m,
                        const SceneRequirements& demand);

/// Stiffness [N/m] in W of a virtual tool's spring with this coupling: the capped stiffness,
/// limited to what the device can display, minus the stiffness of effects (up to half of the caps),
/// which would otherwise scale both at the moment of a contact. Rotation follows by the lever
/// (`bounds`, as fitted). 0: no spring, or none may be displayed.
double spring_n_per_m(const FittedCoupling& fitted, const scene::Scene& scene,
                      const coupling::design::DeviceModel& device,
                      const rendering::StiffnessBounds& bounds) noexcept;

/// The spring in series with a penalty contact under this coupling, in W: the hand is shown the
/// certified stiffness at the stiffest contact that the scene has, and never more. `alone`: of the
/// contact without effects, whose stiffness is left free, up to half of the caps. A body's grip is
/// the contact of a scene with one. Along, rigid with a virtual tool, without caps, and where all
/// that pushes together is no stiffer than they are. Its rotation is infinite on a device that
/// returns no torque. Forces of position (guides, magnets, fields) that are stiffer than the half
/// that is left free for effects have a spring of their own, so that no cap scales them or what
/// else acts with them.
rendering::Compliance series_spring(const FittedCoupling& fitted, const scene::Scene& scene,
                                    const coupling::design::DeviceModel& device,
                                    const rendering::StiffnessBounds& alone,
                                    const rendering::StiffnessBounds& bounds) noexcept;

}  // namespace voxtouch::device_fit
