#pragma once
/// The coupling that a scene runs with on a device: designed where the scene asks for that, set by
/// hand and judged where not.
#include <string>

#include "core/coupling/design/designer.hpp"
#include "core/device_fit/scene_requirements.hpp"
#include "core/rendering/plan.hpp"
#include "core/rendering/series_spring.hpp"
#include "core/scene/design_options.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

struct FittedCoupling {
  coupling::CouplingSpec spec;  ///< what to run, in W
  coupling::design::Design
      design;             ///< at the hand: what was found, or the judgement of what was set by hand
  bool designed = false;  ///< false: set by hand in the scene
  std::string
      impossible;  ///< why there is none that may run, whatever the effects do; empty: there is one
  std::string refusal;  ///< why it must not run with the effects as they are, a sentence with what
                        ///< to do; empty: it may
};

/// `bounds`: what the scene's contact and effects can show, in W; `demand`: what they request in
/// addition to it. The same arguments give bit-identical results. Some milliseconds to some tenths
/// of a second; not for the loop. Numbers that nothing can be designed for (a device without mass,
/// say) come back as a refusal.
FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const rendering::StiffnessBounds& bounds,
                            const SceneRequirements& demand);
/// The same with the scene's effects as it has them.
FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const coupling::design::ContactRange& translation,
                            const coupling::design::ContactRange& rotation);

/// The refusal of a coupling that has been fitted already, for other effects or a device that has
/// changed: the same code, without a new fit. Some microseconds.
std::string judge_again(const FittedCoupling& fitted, const scene::Scene& scene,
                        const coupling::design::DeviceModel& device, double one_point_n_per_m,
                        const SceneRequirements& demand);

/// Stiffness [N/m] in W of a virtual tool's spring under this coupling: what the caps let through,
/// of which none is taken off any more, and no more than the device can show. Effects may add their
/// stiffness to it, so theirs is left free, up to half of the caps: else the cap would make both
/// weaker at once, in the moment of a touch. Against rotation the lever goes with it (`bounds`, as
/// it was fitted to). 0: none may be displayed, or there is no spring.
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
