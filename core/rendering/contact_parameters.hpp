#pragma once
/// From what a scene asks for to what the force laws need.
#include <optional>

#include "core/contact/contact_model.hpp"
#include "core/pointshell/pointshell.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

inline constexpr double kProbeStiffness = 1e6;  ///< [N/m^3]

/// Parameters of the model `kind` for this scene and shell. Points weigh by area where the scene
/// gives its stiffness per area, and for the models that know no other way. A scene that gives it
/// per point and is looked at through one of those
/// (`voxtouch probe --model field`) gets k = K N / A, N points, A their area: the same stiffness
/// once all points push. `weights` overrides the scene, with the same rule; it does not judge
/// whether the model knows them. A scene with a virtual tool gives no stiffness; its contact
/// models, which only `voxtouch probe` and `accuracy` ask, get kProbeStiffness.
contact::ContactParameters contact_parameters(const scene::ContactSpec& spec,
                                              contact::ContactModelKind kind,
                                              const pointshell::Pointshell& shell,
                                              std::optional<contact::PointWeights> weights = {});

}  // namespace voxtouch::rendering
