#pragma once
/// Converts stiffness between W, the frame of scenes, and the hand, for which a coupling is
/// designed.
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

/// Factors from W to the hand, for [N/m, Ns/m] and for [Nm/rad, Nms/rad].
struct HandScales {
  double translation = 1.0;  ///< s f
  double rotation = 1.0;     ///< f / s
};
/// Factors for a device with the scales s and f. Real-time safe.
HandScales hand_scales(const scene::WorkspaceMapping& device) noexcept;

/// The problem of the designer for this scene on this device: the scene's `design`, or the defaults
/// of DesignOptions to evaluate a coupling that is set by hand.
///
/// Device: given at the hand; its grip is used unless the scene names a hand.
///
/// Contact: the ranges are given in W (contact_range.hpp) and converted to the hand, limited by the
/// scene's caps. Rotation is about the tool's origin; an offset to the hand is not included.
///
/// Force layer: the force of a point grows with its depth below the centre of its voxel, over at
/// least e/2 for a wall along the grid (up to sqrt(3)/2 e otherwise): e/2 in W, e / (2 s) at the
/// hand. Deeper, the latched force stays constant (contact_stage.hpp), so an approach must be
/// stopped within this depth.
///
/// Virtual tool: its spring (plan.hpp, spring_of_any_device) is limited to the device's largest
/// stiffness and has no force layer.
///
/// The designer chooses caps if the scene gives none.
coupling::design::DesignProblem design_problem(const scene::Scene& scene,
                                               const coupling::design::DeviceModel& device,
                                               const coupling::design::ContactRange& translation_W,
                                               const coupling::design::ContactRange& rotation_W);

/// Largest spring of a virtual tool that the device can display, in W.
double largest_spring_n_per_m(const scene::Scene& scene,
                              const coupling::design::DeviceModel& device) noexcept;

/// The coupling in W for a design: caps, injected damping and spring-damper are converted, and
/// limited to the scene's caps. Gain, cut-off, damping ratio and velocity estimate have no scale.
coupling::CouplingSpec spec_W(const coupling::design::Design& design,
                              const scene::Scene& scene) noexcept;

/// The inverse conversion, to evaluate a coupling that is set by hand.
coupling::CouplingSpec spec_D(const coupling::CouplingSpec& spec_W,
                              const scene::WorkspaceMapping& device) noexcept;

/// Displayed stiffness [N/m] at the hand for a contact of `bound_n_per_m` in W: limited by the cap,
/// times both scales of the device.
double stiffness_at_hand_n_per_m(const coupling::CouplingSpec& spec,
                                 const scene::WorkspaceMapping& device,
                                 double bound_n_per_m) noexcept;

/// The device's largest force [N] and torque [Nm] in W: divided by f, and multiplied by s / f.
/// Infinity and 0 are kept.
coupling::CouplingLimits limits_W(const scene::WorkspaceMapping& scales,
                                  const coupling::design::DeviceModel& device) noexcept;

}  // namespace voxtouch::device_fit
