#include "core/fitting/scene_on_device.hpp"

#include <vector>

namespace voxtouch::fitting {
namespace {

std::vector<effects::EffectSpec> ends_of(std::span<const effects::EffectReach> effects) {
  std::vector<effects::EffectSpec> ends;
  for (const effects::EffectReach& effect : effects)
    ends.push_back(effect.spec());
  return ends;
}

bool no_more_than(const DeviceDemand& what, const DeviceDemand& shown) {
  return what.least_stiffness_n_per_m <= shown.least_stiffness_n_per_m &&
         what.damping.all <= shown.damping.all && what.turning.all <= shown.turning.all &&
         (what.torque.empty() || !shown.torque.empty()) &&
         what.external.force_n <= shown.external.force_n &&
         what.external.torque_nm <= shown.external.torque_nm;
}

}  // namespace

void SceneOnDevice::device_is(const coupling::design::DeviceModel& device) {
  device_ = device;
  running_.reset(), next_.reset();
}

const FittedCoupling& SceneOnDevice::fitted_for(const scene::Scene& scene,
                                                const rendering::StiffnessBounds& bounds) {
  if (running_ && running_->bounds == bounds)
    return running_->coupling;
  if (!next_ || next_->bounds != bounds)
    next_ = Fit{bounds, fit_coupling(scene, *device_, bounds, {})};
  return next_->coupling;
}

std::string SceneOnDevice::judged(const FittedCoupling& fitted, const scene::Scene& scene,
                                  const rendering::StiffnessBounds& bounds,
                                  const DeviceDemand& demand) const {
  return judge_again(fitted, scene, *device_, bounds.translation.one_point, demand);
}

void SceneOnDevice::runs(const scene::Scene& scene, const rendering::StiffnessBounds& contact_alone,
                         const rendering::StiffnessBounds& bounds, const DeviceDemand& shown) {
  shown_ = shown;
  if (!device_)
    return;
  running_ = Fit{bounds, fitted_for(scene, bounds)};
  refusal_ = judged(running_->coupling, scene, bounds, shown);
  spring_n_per_m_ = voxtouch::fitting::spring_n_per_m(running_->coupling, scene, *device_, bounds);
  series_ =
      voxtouch::fitting::series_spring(running_->coupling, scene, *device_, contact_alone, bounds);
}

std::string SceneOnDevice::why_not(const scene::Scene& scene,
                                   const rendering::StiffnessBounds& contact_alone,
                                   std::span<const effects::EffectReach> effects) {
  if (!device_)
    return {};
  const std::vector<effects::EffectSpec> ends = ends_of(effects);
  const rendering::StiffnessBounds bounds = rendering::with_effects(contact_alone, ends);
  const FittedCoupling& next = fitted_for(scene, bounds);
  const DeviceDemand end = demand_of(scene, effects::at_rest(ends));
  std::string why = judged(next, scene, bounds, end);
  if (!refusal_.empty())
    return no_more_than(end, shown_) ? std::string() : why;
  if (!why.empty())
    return why;
  const DeviceDemand way = larger_of(shown_, demand_of(scene, effects));
  why = judged(next, scene, bounds, way);
  if (why.empty())
    why = judged(running_->coupling, scene, running_->bounds, way);
  return why.empty() ? why
                     : why +
                           " (That is on the way from what is felt now; ask again when it has "
                           "settled, after 0.3 s.)";
}

}  // namespace voxtouch::fitting
