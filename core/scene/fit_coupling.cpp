#include "core/scene/fit_coupling.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/scene/design_request.hpp"
#include "core/scene/device_check.hpp"

namespace voxtouch {
namespace {

/// A coupling set by hand is the user's own choice: it runs without a certificate, but not where even one point is more than the
/// device can show.
std::string refusal_by_hand(const Scene& scene, const DeviceModel& device, double one_point_n_per_m) {
  const DeviceFacts facts{device.translation.max_stiffness, device.timing.period_s, device.translation.max_effort};
  const DeviceCheck check = check_device(scene, facts, std::max(one_point_n_per_m, least_stiffness_n_per_m(scene)));
  return check.fits() ? "" : check.errors.front();
}

/// A sample, its transport, and half of the period that its force is held for.
double late_s(const LoopTiming& timing) { return timing.delay_s + 1.5 * timing.period_s; }

std::string refusal_of(const Design& design, const Scene& scene, const DeviceModel& device) {
  if (design.status != DesignStatus::kInfeasible || scene.design->run_infeasible) return "";
  return fmt::format(
      "No coupling holds for {} with this scene: {} To have it: {} Or set coupling.run_infeasible: true in the scene "
      "to run "
      "what was found ({:.3g} N/m).",
      device.name, fmt::join(design.reasons, " "), fmt::join(design.remedies, " "), design.translation.shown_stiffness);
}

}  // namespace

FittedCoupling fit_coupling(const Scene& scene, const DeviceModel& device, Grip grip, const ContactRange& translation,
                            const ContactRange& rotation) {
  FittedCoupling out;
  out.designed = scene.design.has_value();
  try {
    const DesignRequest request = design_request(scene, device, grip, translation, rotation);
    if (out.designed) {
      out.design = design_coupling(request);
      out.spec = spec_in_world(out.design, scene);
      out.refusal = refusal_of(out.design, scene, device);
    } else {
      out.design = judge_coupling(request, spec_at_hand(scene.coupling, scene.device));
      out.spec = scene.coupling;
      // The controller is a safety net for every coupling; how much it may add is the device's matter, not the scene's.
      const CouplingSpec judged = spec_in_world(out.design, scene);
      out.spec.passivity_damping_limit_ns_per_m = judged.passivity_damping_limit_ns_per_m;
      out.spec.passivity_damping_limit_nms_per_rad = judged.passivity_damping_limit_nms_per_rad;
      out.refusal = refusal_by_hand(scene, device, translation.one_point);
    }
    if (out.refusal.empty())
      out.refusal = effects_damp_too_much(scene, out.spec,
                                          {device.translation.inertia_min, late_s(device.timing)});
  } catch (const std::invalid_argument& error) {
    out.refusal = error.what();
  }
  return out;
}

double stiffness_at_hand_n_per_m(const FittedCoupling& fitted, const DeviceSpec& device,
                                 double bound_n_per_m) noexcept {
  return displayed_stiffness_n_per_m(fitted.spec, bound_n_per_m) * hand_scales(device).translation;
}

}  // namespace voxtouch
