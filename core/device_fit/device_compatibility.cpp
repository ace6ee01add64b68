#include "core/device_fit/device_compatibility.hpp"

#include <vector>

namespace voxtouch::device_fit {
namespace {

std::vector<effects::EffectSpec> ends_of(std::span<const effects::EffectReach> effects) {
  std::vector<effects::EffectSpec> ends;
  for (const effects::EffectReach& effect : effects)
    ends.push_back(effect.spec());
  return ends;
}

bool no_more_than(const SceneRequirements& what, const SceneRequirements& displayed) {
  return what.least_stiffness_n_per_m <= displayed.least_stiffness_n_per_m &&
         what.damping.all <= displayed.damping.all && what.rotation.all <= displayed.rotation.all &&
         (what.torque.empty() || !displayed.torque.empty()) &&
         what.external.force_n <= displayed.external.force_n &&
         what.external.torque_nm <= displayed.external.torque_nm;
}

}  // namespace

void DeviceCompatibility::set_device(const coupling::design::DeviceModel& device) {
  device_ = device;
  running_.reset(), next_.reset();
}

const FittedCoupling& DeviceCompatibility::fitted_for(const scene::Scene& scene,
                                                      const rendering::StiffnessBounds& bounds) {
  if (running_ && running_->bounds == bounds)
    return running_->coupling;
  if (!next_ || next_->bounds != bounds)
    next_ = Fit{bounds, fit_coupling(scene, *device_, bounds, {})};
  return next_->coupling;
}

Refusal DeviceCompatibility::judged(const FittedCoupling& fitted, const scene::Scene& scene,
                                    const rendering::StiffnessBounds& bounds,
                                    const SceneRequirements& demand) const {
  return judge_again(fitted, scene, *device_, bounds.translation.one_point, demand);
}

void DeviceCompatibility::runs(const scene::Scene& scene,
                               const rendering::StiffnessBounds& contact_alone,
                               const rendering::StiffnessBounds& bounds,
                               const SceneRequirements& displayed) {
  displayed_ = displayed;
  if (!device_)
    return;
  running_ = Fit{bounds, fitted_for(scene, bounds)};
  refusal_ = judged(running_->coupling, scene, bounds, displayed);
  spring_n_per_m_ =
      voxtouch::device_fit::spring_n_per_m(running_->coupling, scene, *device_, bounds);
  series_ = voxtouch::device_fit::series_spring(running_->coupling, scene, *device_, contact_alone,
                                                bounds);
}

Refusal DeviceCompatibility::check(const scene::Scene& scene,
                                   const rendering::StiffnessBounds& contact_alone,
                                   std::span<const effects::EffectReach> effects) {
  if (!device_)
    return {};
  const std::vector<effects::EffectSpec> ends = ends_of(effects);
  const rendering::StiffnessBounds bounds = rendering::with_effects(contact_alone, ends);
  const FittedCoupling& next = fitted_for(scene, bounds);
  const SceneRequirements end = demand_of(scene, effects::at_rest(ends));
  Refusal why = judged(next, scene, bounds, end);
  if (!refusal_.empty())
    return no_more_than(end, displayed_) ? Refusal() : why;
  if (!why.empty())
    return why;
  const SceneRequirements on_path = larger_of(displayed_, demand_of(scene, effects));
  why = judged(next, scene, bounds, on_path);
  if (why.empty())
    why = judged(running_->coupling, scene, running_->bounds, on_path);
  why.in_transition = true;
  return why;
}

}  // namespace voxtouch::device_fit
