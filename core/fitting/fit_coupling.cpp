#include "core/fitting/fit_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/fitting/design_problem.hpp"
#include "core/fitting/device_check.hpp"

namespace voxtouch::fitting {
namespace {

std::string refusal_of(const coupling::design::Design& design, const scene::Scene& scene,
                       const coupling::design::DeviceModel& device) {
  if (design.status != coupling::design::DesignStatus::kInfeasible || scene.design->run_infeasible)
    return "";
  return fmt::format(
      "No coupling holds for {} with this scene: {} To have it: {} Or set coupling.run_infeasible: "
      "true in the scene "
      "to run what was found ({:.3g} N/m).",
      device.name, fmt::join(design.reasons, " "), fmt::join(design.remedies, " "),
      design.translation.shown_stiffness);
}

/// What is left of a cap for the spring.
double beside_effects(double cap, const coupling::design::ContactRange& range) noexcept {
  constexpr double kMinShare = 0.5;
  return std::max(cap - (range.all_points - range.one_point), kMinShare * cap);
}

}  // namespace

FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const rendering::StiffnessBounds& bounds, const DeviceDemand& demand) {
  FittedCoupling out;
  out.designed = scene.design.has_value();
  try {
    const coupling::design::DesignProblem problem =
        design_problem(scene, device, bounds.translation, bounds.rotation);
    if (out.designed) {
      out.design = coupling::design::design_coupling(problem);
      out.spec = spec_W(out.design, scene);
      out.impossible = refusal_of(out.design, scene, device);
    } else {
      out.design = coupling::design::judge_coupling(problem, spec_D(scene.coupling, scene.device));
      out.spec = scene.coupling;
      // The controller is a safety net for every coupling; how much it may add is the device's
      // matter, not the scene's.
      const coupling::CouplingSpec judged = spec_W(out.design, scene);
      out.spec.passivity_damping_limit_ns_per_m = judged.passivity_damping_limit_ns_per_m;
      out.spec.passivity_damping_limit_nms_per_rad = judged.passivity_damping_limit_nms_per_rad;
    }
  } catch (const std::invalid_argument& error) {
    out.impossible = error.what();
  }
  out.refusal = judge_again(out, scene, device, bounds.translation.one_point, demand);
  return out;
}

FittedCoupling fit_coupling(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                            const coupling::design::ContactRange& translation,
                            const coupling::design::ContactRange& rotation) {
  return fit_coupling(scene, device, {translation, rotation}, demand_of(scene));
}

std::string judge_again(const FittedCoupling& fitted, const scene::Scene& scene,
                        const coupling::design::DeviceModel& device, double one_point_n_per_m,
                        const DeviceDemand& demand) {
  if (!fitted.impossible.empty())
    return fitted.impossible;
  return why_not_felt(scene, &fitted.spec, device, one_point_n_per_m, demand);
}

double spring_n_per_m(const FittedCoupling& fitted, const scene::Scene& scene,
                      const coupling::design::DeviceModel& device,
                      const rendering::StiffnessBounds& bounds) noexcept {
  if (!fitted.impossible.empty() || !rendering::is_spring(bounds))
    return 0.0;
  const coupling::CouplingSpec& spec = fitted.spec;
  double spring = std::min(largest_spring_n_per_m(scene, device),
                           beside_effects(spec.stiffness_cap_n_per_m, bounds.translation));
  const double lever2 = bounds.rotation.one_point / bounds.translation.one_point;
  if (lever2 > 0.0)
    spring =
        std::min(spring, beside_effects(spec.stiffness_cap_nm_per_rad, bounds.rotation) / lever2);
  return std::isfinite(spring) ? std::max(spring, 0.0) : 0.0;
}

}  // namespace voxtouch::fitting
