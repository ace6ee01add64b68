#include "nodes/design_text/design_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/coupling/design/design_axis.hpp"

namespace voxtouch::design_text {
namespace {

using coupling::design::AxisDesign;
using coupling::design::Design;
using coupling::design::DesignReason;
using coupling::design::LeastDamping;

/// Name and units of one kind of motion.
struct Motion {
  const char *name, *stiffness, *damping, *inertia, *effort, *position;
};
constexpr std::array kMotions{Motion{"Translation", "N/m", "Ns/m", "kg", "N", "m"},
                              Motion{"Rotation", "Nm/rad", "Nms/rad", "kg m^2", "Nm", "rad"}};

std::string corner_of(const coupling::design::LoopCase& one, const Motion& units) {
  const coupling::design::LoopPlant& p = one.plant;
  const std::string device = fmt::format("{:.3g} {}", p.mass, units.inertia);
  const char* when = one.slow ? ", slowest timing" : "";
  if (!one.gripped)
    return fmt::format("released, {}{}", device, when);
  return fmt::format("gripped ({:.3g} {}, {:.3g} {}, {:.3g} {}), {}{}", p.hand_mass, units.inertia,
                     p.hand_damping, units.damping, p.hand_stiffness, units.stiffness, device,
                     when);
}

std::string reason_of(const Design& design, const DesignReason& reason) {
  using enum coupling::design::DesignLimit;
  const AxisDesign& d = coupling::design::axis_of(design, reason.axis);
  const Motion& u = kMotions[reason.axis];
  const std::string worst = worst_case_of(design, reason.axis);
  const auto& v = reason.values;
  // Of both axes: what `text` gives for each axis that has one.
  const auto both = [](const auto& text) {
    const std::string first = text(0), second = text(1);
    return first + (first.empty() || second.empty() ? "" : " and ") + second;
  };
  switch (reason.what) {
    case kNoStableStiffness:
      return fmt::format("{}: no stiffness is stable ({}).", u.name, worst);
    case kEncoderStep:
      return fmt::format(
          "{}: an encoder step of {:.2g} {} may make {:.2g} {}, since a released device with "
          "{:.2g} {} of dry friction bounces on it; displayed {:.3g}, requested {:.4g} {}.",
          u.name, v[0], u.position, v[1], u.effort, v[2], u.effort, d.displayed_stiffness,
          d.requested_stiffness, u.stiffness);
    case kPassiveHand:
      return fmt::format(
          "{}: stability limit {:.3g} {} with any passive hand; at gain margin {:.3g}, displayed "
          "{:.3g}, requested {:.4g} {}.",
          u.name, d.critical_stiffness, u.stiffness, d.gain_margin, d.displayed_stiffness,
          d.requested_stiffness, u.stiffness);
    case kMinDampingRatio:
      return fmt::format(
          "{}: limited by the minimum damping ratio; displayed {:.3g}, requested {:.4g} {}; {} "
          "becomes unstable at {:.3g}.",
          u.name, d.displayed_stiffness, d.requested_stiffness, u.stiffness, worst,
          d.critical_stiffness);
    case kStability:
      return fmt::format(
          "{}: {} becomes unstable at {:.3g} {}; at gain margin {:.3g}, displayed {:.3g}, "
          "requested {:.4g} {}.",
          u.name, worst, d.critical_stiffness, u.stiffness, d.gain_margin, d.displayed_stiffness,
          d.requested_stiffness, u.stiffness);
    case kDeviceStiffness:
      return fmt::format("{}: device limit {:.4g} {}, all points together {:.4g}.", u.name, v[0],
                         u.stiffness, v[1]);
    case kInjectedDamping: {
      const std::string bound = fmt::format(
          " It is limited to {:.2g} of the contact force; unlimited (damping_force_ratio: 0), "
          "{:.4g} instead of {:.4g} {} is stable.",
          design.spec.damping_force_ratio, v[0], v[1], u.stiffness);
      return fmt::format(
          "{}: injected damping of {:.3g} {} (velocity from {}) increases the stable stiffness.{}",
          u.name, d.injected_damping, u.damping, text_of(d.velocity), v[0] > 0.0 ? bound : "");
    }
    case kFilterLag:
      return fmt::format(
          "At {:.3g} Hz the filter's lag allows only {} without injected damping; chosen cut-off "
          "{:.3g} Hz.",
          v[0], both([&](std::size_t axis) {
            return coupling::design::axis_of(design, axis).requested_stiffness > 0.0
                       ? fmt::format("{:.3g} {}", v[1 + axis], kMotions[axis].stiffness)
                       : "";
          }),
          design.spec.cutoff_hz);
    case kMinDampingCost:
      return fmt::format(
          "The minimum damping ratios cost {} (released {:.2g}, gripped {:.2g}); "
          "min_damping_ratio: 0 in the scene's coupling removes them.",
          both([&](std::size_t axis) {
            const double left = coupling::design::axis_of(design, axis).displayed_stiffness;
            return v[axis] > 0.0 ? fmt::format("{:.4g} of {:.4g} {}", v[axis], left + v[axis],
                                               kMotions[axis].stiffness)
                                 : "";
          }),
          design.min_damping.released, design.min_damping.gripped);
    case kMinDampingDropped:
      return fmt::format(
          "Minimum damping ratios of {} released and {} gripped leave too little stiffness; they "
          "are not applied.",
          v[0], v[1]);
    case kWithoutFilter:
      return fmt::format(
          "Displayed fraction of the requested stiffness: {:.3g} % without shaping filter, {:.3g} "
          "% with it.",
          100.0 * v[0], 100.0 * v[1]);
    case kDampingForceRatio:
      return fmt::format(
          "Injected damping is limited to {:.2g} of the contact force (default {:.2g}). Displayed "
          "fraction of the request: default {:.3g} %, this limit {:.3g} %, no limit {:.3g} %.",
          v[0], v[1], 100.0 * v[2], 100.0 * v[3], 100.0 * v[4]);
    case kNoDampingForceRatio:
      return fmt::format(
          "Injected damping has no limit: damping_force_ratio {:.2g} displays only {:.3g} %{} of "
          "the requested stiffness, not {:.3g} %. The impact force then depends on impact "
          "velocity, not on contact stiffness.",
          v[0], 100.0 * v[1],
          v[3] > 0.0 ? fmt::format(" and with {:.2g} {:.3g} %", v[3], 100.0 * v[4]) : "",
          100.0 * v[2]);
    case kGainMargin:
      return fmt::format(
          "{}: displayed stiffness {:.4g} {}; {} becomes unstable at {:.4g}: gain margin {:.3g}, "
          "required {:.3g}.",
          u.name, d.displayed_stiffness, u.stiffness, worst, d.critical_stiffness, d.gain_margin,
          v[0]);
    case kSlowestMode:
      return fmt::format(
          "{}: at {} the loop's slowest mode does not decay (spectral radius {:.9g}).", u.name,
          d.spectral_radius < 1.0 ? "1/100 of the gain margin" : "the gain margin", v[0]);
    case kDisplayedStiffness:
      return fmt::format("{}: displayed stiffness {:.4g} {}, device limit {:.4g}.", u.name,
                         d.displayed_stiffness, u.stiffness, v[0]);
    case kDampingPassiveHand:
      return fmt::format("{}: injected damping cannot be certified with `hand: any_passive`.",
                         u.name);
    case kDampingLimit:
      return fmt::format(
          "{}: injected damping {:.4g} {}, limit {:.4g} (half of the stability limit, or the noise "
          "limit).",
          u.name, d.injected_damping, u.damping, v[0]);
    case kSlowVelocity:
      return fmt::format(
          "{}: with the slow velocity of {:.3g} Hz only (motions within {:.3g} m/s), {:.4g} {} "
          "does not keep {:.3g} of the gain margin.",
          u.name, design.spec.slow_velocity_hz, design.spec.velocity_band_m_per_s,
          d.displayed_stiffness, u.stiffness, v[0]);
  }
  return "";
}

}  // namespace

std::string_view sentence_of(std::string_view status) noexcept {
  using Row = std::pair<std::string_view, std::string_view>;
  static constexpr std::array kRows{
      Row{"as_requested", "the requested stiffness is stable at the requested cut-off"},
      Row{"bandwidth_raised",
          "the requested stiffness is stable at a higher cut-off than requested"},
      Row{"damping_added", "the requested stiffness is stable with injected damping in contact"},
      Row{"stiffness_reduced", "less than the requested stiffness is stable"},
      Row{"infeasible", "no usable stiffness is stable, so no force is commanded"},
      Row{"configured", "the scene sets the coupling; the designer only checks it"}};
  const auto found = std::ranges::find(kRows, status, &Row::first);
  return found == kRows.end() ? std::string_view() : found->second;
}

std::string sentence_of(const device_fit::Refusal& refusal) {
  std::string out = refusal.error;
  if (refusal.infeasible)
    out = fmt::format(
        "No stable coupling for {} with this scene: {} Set coupling.run_infeasible: true to run "
        "the best found ({:.3g} N/m).",
        refusal.device, fmt::join(reasons_of(*refusal.infeasible), " "),
        refusal.infeasible->translation.displayed_stiffness);
  if (refusal.in_transition && !out.empty())
    out +=
        " (This is during the transition from the current value; repeat the request after 0.3 s.)";
  return out;
}

std::vector<std::string> reasons_of(const Design& design) {
  std::vector<std::string> out;
  for (const DesignReason& reason : design.reasons)
    out.push_back(reason_of(design, reason));
  return out;
}

std::string worst_case_of(const Design& design, std::size_t axis) {
  const AxisDesign& d = coupling::design::axis_of(design, axis);
  if (d.requested_stiffness == 0.0)
    return "";
  return d.any_passive_hand ? "a passive hand" : corner_of(d.worst_case, kMotions[axis]);
}

std::string case_of(const LeastDamping& least) {
  if (least.ratio == 1.0)
    return "";
  const Motion& motion = kMotions[least.axis];
  return fmt::format("{}: {}", motion.name, corner_of(least.where, motion));
}

std::string out_of_reach(const LeastDamping& best) {
  const std::string where = case_of(best);
  return where.empty()
             ? ""
             : fmt::format("{} reaches a damping ratio of {:.2g} at most", where, best.ratio);
}

std::string text_of(const coupling::design::VelocityEstimate& velocity) {
  return velocity.window > 0
             ? fmt::format("a window of {} samples", coupling::window_span(velocity.window))
             : fmt::format("a filter of {:.3g} Hz", velocity.filter_hz);
}

std::vector<std::string> damping_notes(const coupling::CouplingSpec& spec) {
  std::vector<std::string> out;
  if (damps_on_slow_velocity(spec))
    out.push_back(
        fmt::format("uses a velocity filter of {:.3g} Hz within {:.2g} mm/s (encoder quantisation)",
                    spec.slow_velocity_hz, 1e3 * spec.velocity_band_m_per_s));
  if (spec.damping_force_ratio > 0.0 && spec.injected_damping_ns_per_m > 0.0)
    out.push_back(fmt::format("is limited to {:.3g} of the contact and effect force, plus {:.2g} N",
                              spec.damping_force_ratio, spec.damping_force_offset_n));
  return out;
}

}  // namespace voxtouch::design_text
