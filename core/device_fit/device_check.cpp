#include "core/device_fit/device_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/coupling/coupling_spec.hpp"
#include "core/device_fit/design_problem.hpp"

namespace voxtouch::device_fit {

namespace {

/// Delay of a sample, its transport, and half of the period for which its force is held.
double force_delay_s(const coupling::design::LoopTiming& timing) {
  return timing.delay_s + 1.5 * timing.period_s;
}

/// A manual coupling is the user's choice and runs without a certificate. It is refused if a single
/// contact exceeds what the device can display.
std::string too_stiff_by_hand(const scene::Scene& scene,
                              const coupling::design::DeviceModel& device, double least_n_per_m,
                              const SceneRequirements& demand) {
  const double demanded = demand.least_stiffness_n_per_m;
  const double displayed = std::isunordered(least_n_per_m, demanded)
                               ? std::numeric_limits<double>::quiet_NaN()
                               : std::max(least_n_per_m, demanded);
  const DeviceCheck check = check_device(scene, device, displayed, demand.stiffest);
  return check.fits() ? "" : check.errors.front();
}

/// The words of a sentence about one of the two.
struct DampingWords {
  const char *damp, *unit, *effort, *inertia;
};
constexpr DampingWords kMoving{"damp", "Ns/m", "force", "kg"},
    kRotation{"damp rotation", "Nms/rad", "torque", "kg m^2"};

std::string damps_too_much(const DampingDemand& demand, double scale, double late_s, double inertia,
                           const DampingWords& words) {
  if (demand.all == 0.0)
    return {};
  const double at_hand = demand.all * scale, limit = 0.25 * std::numbers::pi * inertia / late_s;
  if (at_hand >= 0.0 && at_hand <= limit)
    return {};
  return fmt::format(
      "{}{}the effects {} with up to {:.3g} {} at the hand (mostly '{}'). With {} latency of "
      "{:.3g} ms, a released device of {:.3g} {} allows {:.3g} {} (margin 2). Reduce it below "
      "{:.3g} {}.",
      demand.place, demand.place.empty() ? "" : ": ", words.damp, at_hand, words.unit, demand.name,
      words.effort, 1e3 * late_s, inertia, words.inertia, limit, words.unit,
      demand.largest * limit / at_hand, words.unit);
}

/// Words of a sentence about force or torque, and the factor from W to the hand.
struct EffortWords {
  const char *effort, *unit, *key;
  double scale;
};

/// NaN does not pass.
std::string check_demand(const ExternalDemand& external, double at_hand, double limit,
                         const EffortWords& words) {
  if (at_hand <= limit)
    return {};
  return fmt::format(
      "{}{}the effect '{}' may request a {} of {:.4g} {} at the hand, device limit {:.4g} {}. "
      "Reduce {} to {:.4g} {}.",
      external.place, external.place.empty() ? "" : ": ", external.name, words.effort, at_hand,
      words.unit, limit, words.unit, words.key, limit / words.scale, words.unit);
}

}  // namespace

std::string torque_not_displayed(const SceneRequirements& demand, bool gives_torque) {
  if (gives_torque || demand.torque.empty())
    return {};
  return fmt::format(
      "The effect '{}' needs torque, which the device does not return. Remove the effect, set its "
      "torque to 0, or use a 6-DOF device.",
      demand.torque);
}

std::string external_too_strong(const SceneRequirements& demand,
                                const scene::WorkspaceMapping& scales,
                                const coupling::design::DeviceModel& device) {
  const ExternalDemand& external = demand.external;
  if (external.name.empty())
    return {};
  const double force_scale = scales.force_scale,
               torque_scale = scales.force_scale / scales.position_scale;
  std::string why =
      check_demand(external, external.force_n * force_scale, device.translation.max_effort,
                   {"force", "N", "max_force_n", force_scale});
  if (why.empty() && device.gives_torque)
    why = check_demand(external, external.torque_nm * torque_scale, device.rotation.max_effort,
                       {"torque", "Nm", "max_torque_nm", torque_scale});
  return why;
}

std::string effects_damp_too_much(const SceneRequirements& demand,
                                  const scene::WorkspaceMapping& scales,
                                  const coupling::CouplingSpec& spec,
                                  const coupling::design::DeviceModel& device) {
  const double late_s = coupling::lag_s(spec) + force_delay_s(device.timing);
  const std::string why = damps_too_much(demand.damping, hand_scales(scales).translation, late_s,
                                         device.translation.inertia_min, kMoving);
  if (!why.empty() || !device.gives_torque)
    return why;
  return damps_too_much(demand.rotation, hand_scales(scales).rotation, late_s,
                        device.rotation.inertia_min, kRotation);
}

std::string force_not_displayed(const scene::Scene& scene, const coupling::CouplingSpec* runs,
                                const coupling::design::DeviceModel& device, double least_n_per_m,
                                const SceneRequirements& demand) {
  std::string why = torque_not_displayed(demand, device.gives_torque);
  if (why.empty())
    why = external_too_strong(demand, scene.device, device);
  if (!why.empty() || runs == nullptr)
    return why;
  if (!scene.design)
    why = too_stiff_by_hand(scene, device, least_n_per_m, demand);
  if (!why.empty())
    return why;
  return effects_damp_too_much(demand, scene.device, *runs, device);
}

DeviceCheck check_device(const scene::Scene& scene, const coupling::design::DeviceModel& device,
                         double stiffness_bound_n_per_m, std::string_view stiffest) {
  DeviceCheck out;
  const double max_stiffness = device.translation.max_stiffness;
  if (!(stiffness_bound_n_per_m >= 0.0) || !std::isfinite(stiffness_bound_n_per_m)) {
    out.errors.push_back(fmt::format(
        "The scene's stiffness bound is {} N/m, not a valid stiffness.", stiffness_bound_n_per_m));
    return out;
  }
  if (!(max_stiffness > 0.0))
    out.errors.push_back(fmt::format(
        "The device's largest stiffness is {} N/m; it must be above 0.", max_stiffness));
  const double displayed =
      stiffness_at_hand_n_per_m(scene.coupling, scene.device, stiffness_bound_n_per_m);
  // NaN does not pass.
  if (max_stiffness > 0.0 && !(displayed <= max_stiffness))
    out.errors.push_back(fmt::format(
        "Contact stiffness {:.4g} N/m is {:.4g} N/m at the hand, device limit {:.4g} N/m. Divide "
        "{} by {:.3g}, or reduce the coupling's gain or a scale of the device.",
        stiffness_bound_n_per_m, displayed, max_stiffness,
        stiffest.empty() ? demand_of(scene).stiffest : std::string(stiffest),
        displayed / max_stiffness));
  const coupling::CouplingLimits limits{device.translation.max_effort / scene.device.force_scale,
                                        std::numeric_limits<double>::infinity()};
  for (const coupling::CouplingIssue& issue :
       coupling::validate(scene.coupling, limits, device.timing.period_s))
    (issue.refuse ? out.errors : out.warnings).push_back("Coupling: " + issue.sentence);
  return out;
}

}  // namespace voxtouch::device_fit
