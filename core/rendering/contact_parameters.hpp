#pragma once
/// From what a scene asks for to what the force laws need.
#include <optional>

#include "core/contact/contact_model.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

inline constexpr double kProbeStiffness = 1e6;  ///< [N/m^3]

/// Stiffness per area [N/m^3] at which a cube of this mass rests scene::kRestDepthM deep on a plane
/// under standard gravity g. A flat face larger than a sixth of the surface A rests less deep.
///
///     k = m g / (scene::kRestDepthM A / 6)
double body_stiffness_n_per_m3(double mass_kg, double area_m2) noexcept;

/// Parameters of the model `kind` for this scene and shell. Points weigh by area where the scene
/// gives its stiffness per area, and for the models that know no other way. A scene that gives it
/// per point and is looked at through one of those
/// (`voxtouch probe --model field`) gets k = K N / A, N points, A their area: the same stiffness
/// once all points push. `weights` overrides the scene, with the same rule; it does not judge
/// whether the model knows them. A scene with a virtual tool gives no stiffness; its contact
/// models, which only `voxtouch probe` and `accuracy` ask, get kProbeStiffness. A scene whose
/// stiffness follows from a body's mass gets `body_stiffness_n_per_m3`.
contact::ContactParameters contact_parameters(const scene::ContactSpec& spec,
                                              contact::ContactModelKind kind,
                                              const pointshell::Pointshell& shell,
                                              std::optional<contact::PointWeights> weights = {});

}  // namespace voxtouch::rendering
