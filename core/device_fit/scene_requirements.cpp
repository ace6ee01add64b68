#include "core/device_fit/scene_requirements.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace voxtouch::device_fit {
namespace {

void add_stiffness(const scene::Scene& scene, std::span<const effects::EffectReach> effects,
                   SceneRequirements& demand) {
  double most = demand.least_stiffness_n_per_m = scene.contact.stiffness_n_per_m;
  demand.stiffest =
      scene.virtual_tool() ? "coupling.stiffness_cap_n_per_m" : "contact.stiffness_n_per_m";
  for (const effects::EffectReach& effect : effects) {
    const effects::EffectSpec& spec = effect.spec();
    const double own = effect.bound().stiffness_n_per_m;
    if (own > most) {
      const std::string place = spec.place.empty() ? "" : fmt::format(" ({})", spec.place);
      most = own,
      demand.stiffest = fmt::format("the effect '{}'{} ({:.4g} N/m)", spec.name, place, own);
    }
    if (spec.kind->needs(spec.values).body) {
      demand.least_stiffness_n_per_m = own;
      return;
    }
    demand.least_stiffness_n_per_m += own;
  }
}

void add(DampingDemand& damping, double own, const effects::EffectSpec& spec) {
  damping.all += own;
  if (own > damping.largest)
    damping.largest = own, damping.name = spec.name, damping.place = spec.place;
}

void add_damping(std::span<const effects::EffectReach> effects, SceneRequirements& demand) {
  for (const effects::EffectReach& effect : effects) {
    const effects::EffectSpec& spec = effect.spec();
    if (spec.kind->needs(spec.values).body)
      continue;  // its damping acts on a movable body
    const effects::EffectBound bound = effect.bound();
    add(demand.damping, bound.damping_ns_per_m, spec);
    add(demand.rotation, bound.damping_nms_per_rad, spec);
  }
}

void add_external(std::span<const effects::EffectReach> effects, SceneRequirements& demand) {
  for (const effects::EffectReach& effect : effects) {
    const effects::EffectSpec& spec = effect.spec();
    if (!spec.kind->needs(spec.values).external)
      continue;
    const effects::EffectBound bound = effect.bound();
    demand.external = {bound.external_force_n, bound.external_torque_nm, spec.name, spec.place};
  }
}

}  // namespace

SceneRequirements demand_of(const scene::Scene& scene) {
  return demand_of(scene, effects::at_rest(scene.effects));
}

SceneRequirements demand_of(const scene::Scene& scene,
                            std::span<const effects::EffectReach> effects) {
  SceneRequirements demand;
  if (!scene.design)
    add_stiffness(scene, effects, demand);
  add_damping(effects, demand);
  add_external(effects, demand);
  for (const effects::EffectReach& effect : effects)
    if (demand.torque.empty() && effect.spec().kind->needs(effect.spec().values).torque)
      demand.torque = effect.spec().name;
  return demand;
}

SceneRequirements larger_of(const SceneRequirements& a, const SceneRequirements& b) {
  SceneRequirements out = b;
  if (a.least_stiffness_n_per_m > b.least_stiffness_n_per_m)
    out.least_stiffness_n_per_m = a.least_stiffness_n_per_m, out.stiffest = a.stiffest;
  if (a.damping.all > b.damping.all)
    out.damping = a.damping;
  if (a.rotation.all > b.rotation.all)
    out.rotation = a.rotation;
  if (out.torque.empty())
    out.torque = a.torque;
  if (out.external.name.empty())
    out.external = a.external;
  out.external.force_n = std::max(a.external.force_n, b.external.force_n);
  out.external.torque_nm = std::max(a.external.torque_nm, b.external.torque_nm);
  return out;
}

double least_stiffness_n_per_m(const scene::Scene& scene) {
  SceneRequirements demand;
  add_stiffness(scene, effects::at_rest(scene.effects), demand);
  return demand.least_stiffness_n_per_m;
}

}  // namespace voxtouch::device_fit
