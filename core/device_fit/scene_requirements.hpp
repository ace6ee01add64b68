#pragma once
/// Requirements of a scene in addition to its contact's stiffness, as numbers and names that the
/// rendering can send to the coupling.
#include <span>
#include <string>

#include "core/effects/effect_reach.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// Damping of effects along the axes [Ns/m] or about them [Nms/rad].
struct DampingDemand {
  double all = 0.0;         ///< of all effects together
  double largest = 0.0;     ///< of the effect with the largest damping
  std::string name, place;  ///< of that effect; the place in the scene may be empty

  bool operator==(const DampingDemand&) const = default;
};

/// Largest request of an effect that follows an external program [N], [Nm].
struct ExternalDemand {
  double force_n = 0.0, torque_nm = 0.0;
  std::string name, place;  ///< of the effect; empty without one

  bool operator==(const ExternalDemand&) const = default;
};

/// In W. All effects count at full gain, also those that are off, so an approved scene stays valid
/// for any gain and switch.
struct SceneRequirements {
  double least_stiffness_n_per_m =
      0.0;               ///< of any contact with all effects; 0 if a designed coupling caps it
  std::string stiffest;  ///< the setting to reduce first
  DampingDemand damping, rotation;  ///< of translation and of rotation
  std::string torque;               ///< name of an effect with torque; empty without one
  ExternalDemand external;

  bool operator==(const SceneRequirements&) const = default;
};

/// Requirements of the scene file.
SceneRequirements demand_of(const scene::Scene& scene);
/// Requirements of the scene's contact with other effects, including all states while they change.
SceneRequirements demand_of(const scene::Scene& scene,
                            std::span<const effects::EffectReach> effects);
/// Requirements while one fades to the other: the larger of each figure.
SceneRequirements larger_of(const SceneRequirements& a, const SceneRequirements& b);

/// Least stiffness of any contact in W: of one point if points have weight one, plus that of the
/// effects; or the grip of a body.
double least_stiffness_n_per_m(const scene::Scene& scene);

}  // namespace voxtouch::device_fit
