#pragma once
/// Between W, where a scene speaks of stiffness, and the hand, where a coupling is designed; and
/// back.
///
/// With position_scale s and force_scale f (device_mapping.hpp) a stiffness or damping against
/// translation is displayed times s f: a metre of the hand is s metres in W, a newton in W is f
/// newtons at the hand. Against rotation it is displayed times f / s: angles are not scaled, and
/// torques carry f / s. Both are the same contact, since levers at the hand are those of W divided
/// by s, and s f / s^2 = f / s.
#include "core/coupling/design/designer.hpp"
#include "core/rendering/plan.hpp"
#include "core/scene/design_options.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// What one [N/m, Ns/m] of W, and one [Nm/rad, Nms/rad] of W, are at the hand.
struct HandScales {
  double translation = 1.0;  ///< s f
  double rotation = 1.0;     ///< f / s
};
/// Those of a device with these scales s and f. Real-time safe.
HandScales hand_scales(const scene::WorkspaceMapping& device) noexcept;

/// What the designer is asked for this scene on this device: the scene's `design`, or the defaults
/// of DesignOptions where the coupling is set by hand (to judge it).
///
///  - `device` as it is, at the hand already; its grip is used unless the scene names a hand.
///  - The contact ranges are given in W (contact_range.hpp) and come out at the hand, already under
///  the scene's caps:
///    those of the ask, or of the coupling set by hand. Rotation is about the tool's origin; a tool
///    offset between that and the hand is not in it.
///  - The force layer: a point's push grows with its depth below its voxel's centre, and within the
///  surface layer that
///    is e/2 at least, for a wall along the grid (up to sqrt(3)/2 e for other directions): e/2 in
///    W, e / (2 s) at the hand. Deeper than that the push does not fall, since the stage holds it
///    (contact_stage.hpp), but it does not grow either: an approach that is to be stopped by the
///    wall's stiffness has that much depth.
///  - A virtual tool's spring (plan.hpp, spring_of_any_device) is brought down to the device's
///  largest stiffness, and grows with the displacement without end: there is no force layer.
///  - The designer may choose caps where the scene gives neither.
coupling::design::DesignProblem design_problem(const scene::Scene& scene,
                                               const coupling::design::DeviceModel& device,
                                               const coupling::design::ContactRange& translation_W,
                                               const coupling::design::ContactRange& rotation_W);

/// Of a virtual tool, in W: what the device can show at most.
double largest_spring_n_per_m(const scene::Scene& scene,
                              const coupling::design::DeviceModel& device) noexcept;

/// What runs in W for a design: its caps, injected damping and spring-damper brought there, and
/// never above the scene's own caps, which the designer took as given. Gain, cut-off, damping ratio
/// and velocity estimate have no scale.
coupling::CouplingSpec spec_W(const coupling::design::Design& design,
                              const scene::Scene& scene) noexcept;

/// The other way, for a coupling that is set by hand and to be judged at the hand.
coupling::CouplingSpec spec_D(const coupling::CouplingSpec& spec_W,
                              const scene::WorkspaceMapping& device) noexcept;

/// Stiffness [N/m] at the hand for a contact of `bound_n_per_m` in W: what the coupling shows of
/// it, up to its cap, times both scales of the device (a metre of the hand is position_scale metres
/// in W, a newton in W is force_scale newtons there).
double stiffness_at_hand_n_per_m(const coupling::CouplingSpec& spec,
                                 const scene::WorkspaceMapping& device,
                                 double bound_n_per_m) noexcept;

/// The device's largest force [N] and torque [Nm] in the units of W: / f and * s / f. Infinity
/// stays infinity and 0 stays 0.
coupling::CouplingLimits limits_W(const scene::WorkspaceMapping& scales,
                                  const coupling::design::DeviceModel& device) noexcept;

}  // namespace voxtouch::device_fit
