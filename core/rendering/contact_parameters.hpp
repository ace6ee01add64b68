#pragma once
/// Derives the parameters of the force laws from a scene.
#include <optional>

#include "core/contact/contact_model.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

inline constexpr double kProbeStiffness = 1e6;  ///< [N/m^3]

/// Stiffness per area [N/m^3] at which a cube of this mass rests at depth scene::kRestDepthM on a
/// plane under standard gravity g. A flat face larger than a sixth of the surface A rests at a
/// smaller depth.
///     k = m g / (scene::kRestDepthM A / 6)
double body_stiffness_n_per_m3(double mass_kg, double area_m2) noexcept;

/// Parameters of the model `kind` for this scene and shell.
/// Points are weighted by area if the scene specifies its stiffness per area, and for models that
/// support no other weights. If a scene specifies it per point and is evaluated with such a model
/// (`voxtouch probe --model field`), the stiffness per area is
///
///     k = K N / A
///
/// with N points of area A: the same stiffness once all points are in contact. `weights` overrides
/// the scene by the same rule; whether the model supports them is not checked here. A scene with a
/// virtual tool specifies no stiffness. Its contact models are used by `voxtouch probe` and
/// `accuracy` only, with kProbeStiffness. A scene whose stiffness follows from the mass of a body
/// gets `body_stiffness_n_per_m3`.
contact::ContactParameters contact_parameters(const scene::ContactSpec& spec,
                                              contact::ContactModelKind kind,
                                              const pointshell::Pointshell& shell,
                                              std::optional<contact::PointWeights> weights = {});

}  // namespace voxtouch::rendering
