#include "core/device_fit/fit_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/device_check.hpp"

namespace voxtouch::device_fit {
namespace {

constexpr double kFreeForEffects = 0.5;  ///< of a cap, at most

/// The part of a cap that effects of that stiffness leave to the spring.
double without_effects(double cap, double effects) noexcept {
  return std::max(cap - effects, (1.0 - kFreeForEffects) * cap);
}
/// Compliance of the spring in series with position-dependent forces, which limits them to half of
/// the cap.
double before_effects(double cap, double effects) noexcept {
  return effects > kFreeForEffects * cap ? rendering::compliance_for(kFreeForEffects * cap, effects)
                                         : 0.0;
}
double without_effect_range(double cap, const coupling::design::ContactRange& range) noexcept {
  return without_effects(cap, range.all_points - range.one_point);
}

bool has_force_of_position(const scene::Scene& scene) noexcept {
  return std::ranges::any_of(scene.effects, [](const effects::EffectSpec& effect) {
    return effect.kind->energy == effects::EnergyBehaviour::kConservative;
  });
}

}  // namespace

FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const rendering::StiffnessBounds& bounds,
                            const SceneRequirements& demand) {
  FittedCoupling out;
  out.designed = scene.design.has_value();
  try {
    const coupling::design::DesignProblem problem =
        design_problem(scene, device, bounds.translation, bounds.rotation);
    if (out.designed) {
      out.design = coupling::design::design_coupling(problem);
      out.spec = spec_W(out.design, scene);
      if (out.design.status == coupling::design::DesignStatus::kInfeasible &&
          !scene.design->run_infeasible)
        out.impossible = {{}, device.name, out.design};
    } else {
      out.design = coupling::design::judge_coupling(problem, spec_D(scene.coupling, scene.device));
      out.spec = scene.coupling;
    }
  } catch (const std::invalid_argument& error) {
    out.impossible.error = error.what();
  }
  out.refusal = judge_again(out, scene, device, bounds.translation.one_point, demand);
  return out;
}

FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const coupling::design::ContactRange& translation,
                            const coupling::design::ContactRange& rotation) {
  return fit_coupling(scene, device, {translation, rotation}, demand_of(scene));
}

Refusal judge_again(const FittedCoupling& fitted, const scene::Scene& scene,
                    const coupling::design::DeviceModel& device, double one_point_n_per_m,
                    const SceneRequirements& demand) {
  if (!fitted.impossible.empty())
    return fitted.impossible;
  return {force_not_displayed(scene, &fitted.spec, device, one_point_n_per_m, demand)};
}

double spring_n_per_m(const FittedCoupling& fitted, const scene::Scene& scene,
                      const coupling::design::DeviceModel& device,
                      const rendering::StiffnessBounds& bounds) noexcept {
  if (!fitted.impossible.empty() || !rendering::is_spring(bounds))
    return 0.0;
  const coupling::CouplingSpec& spec = fitted.spec;
  double spring = std::min(largest_spring_n_per_m(scene, device),
                           without_effect_range(spec.stiffness_cap_n_per_m, bounds.translation));
  const double lever2 = bounds.rotation.one_point / bounds.translation.one_point;
  if (lever2 > 0.0)
    spring = std::min(
        spring, without_effect_range(spec.stiffness_cap_nm_per_rad, bounds.rotation) / lever2);
  return std::isfinite(spring) ? std::max(spring, 0.0) : 0.0;
}

rendering::Compliance series_spring(const FittedCoupling& fitted, const scene::Scene& scene,
                                    const coupling::design::DeviceModel& device,
                                    const rendering::StiffnessBounds& alone,
                                    const rendering::StiffnessBounds& bounds) noexcept {
  if (!fitted.impossible.empty())
    return {};
  const bool body = effects::needs_of(scene.effects).body;
  const double of_effects =
      std::max(0.0, bounds.translation.all_points - alone.translation.all_points);
  const double field = body || !has_force_of_position(scene)
                           ? 0.0
                           : before_effects(fitted.spec.stiffness_cap_n_per_m, of_effects);
  const double without_torque = std::numeric_limits<double>::infinity();
  if (rendering::is_spring(bounds))
    return {0.0, device.gives_torque ? 0.0 : without_torque, field};
  // A matrix with translation and rotation is at most twice its diagonal blocks.
  const double both = device.gives_torque ? 2.0 : 1.0;
  const auto of_axis = [&](double cap, const coupling::design::ContactRange& contact,
                           const coupling::design::ContactRange& all) {
    const double effects = body ? 0.0 : std::max(0.0, all.all_points - contact.all_points);
    return rendering::compliance_for(without_effects(cap, effects),
                                     both * (body ? all : contact).all_points);
  };
  return {of_axis(fitted.spec.stiffness_cap_n_per_m, alone.translation, bounds.translation),
          device.gives_torque
              ? of_axis(fitted.spec.stiffness_cap_nm_per_rad, alone.rotation, bounds.rotation)
              : without_torque,
          field};
}

}  // namespace voxtouch::device_fit
