#pragma once
/// What a scene requires of a device in addition to its contact's stiffness, as plain numbers and
/// names: so that the rendering can send it to the node that has the device.
#include <span>
#include <string>

#include "core/effects/effect_reach.hpp"
#include "core/scene/scene.hpp"

namespace voxtouch::device_fit {

/// What effects damp with, along the axes [Ns/m] or about them [Nms/rad].
struct DampingDemand {
  double all = 0.0;         ///< of all effects together
  double largest = 0.0;     ///< of the one that damps most ...
  std::string name, place;  ///< ... its name, and where it was read, which may be empty

  bool operator==(const DampingDemand&) const = default;
};

/// What an effect may ask for that follows a program outside the ring [N], [Nm].
struct ExternalDemand {
  double force_n = 0.0, torque_nm = 0.0;
  std::string name, place;  ///< of the effect; empty: there is none

  bool operator==(const ExternalDemand&) const = default;
};

/// In W. Effects count at full gain, also those that are switched off: what is found good is good
/// whatever gain or switch do.
struct SceneRequirements {
  double least_stiffness_n_per_m =
      0.0;  ///< that any contact shows, all effects with it; 0 where a designed coupling caps it
  std::string stiffest;             ///< what a person would lower first
  DampingDemand damping, rotation;  ///< of the tool's motion, and of its rotation
  std::string torque;               ///< name of an effect that gives torque; empty: none does
  ExternalDemand external;

  bool operator==(const SceneRequirements&) const = default;
};

/// Of the scene as it is.
SceneRequirements demand_of(const scene::Scene& scene);
/// Of the scene's contact with other effects, wherever they may be on their way.
SceneRequirements demand_of(const scene::Scene& scene,
                            std::span<const effects::EffectReach> effects);
/// Both while one fades over to the other: of each figure the larger, since a blend shows no more
/// than the more demanding one.
SceneRequirements larger_of(const SceneRequirements& a, const SceneRequirements& b);

/// What any contact shows of stiffness at least, in W: one point alone where points weigh one each,
/// with all that the effects may display in addition to it; or the grip of a body.
double least_stiffness_n_per_m(const scene::Scene& scene);

}  // namespace voxtouch::device_fit
