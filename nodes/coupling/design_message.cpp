#include "nodes/coupling/design_message.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "nodes/design_text/design_text.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::coupling_node {
namespace {

struct SpecNumber {
  std::string_view name;
  double coupling::CouplingSpec::*of_spec;
  double msg::CouplingDesign::*of_message;
};
#define VOXTOUCH_NUMBER(name) \
  SpecNumber { #name, &coupling::CouplingSpec::name, &msg::CouplingDesign::name }
/// All numbers of a specification except `velocity_window`, which is a count.
constexpr SpecNumber kSpecNumbers[] = {VOXTOUCH_NUMBER(cutoff_hz),
                                       VOXTOUCH_NUMBER(damping_ratio),
                                       VOXTOUCH_NUMBER(gain),
                                       VOXTOUCH_NUMBER(stiffness_n_per_m),
                                       VOXTOUCH_NUMBER(damping_ns_per_m),
                                       VOXTOUCH_NUMBER(stiffness_cap_n_per_m),
                                       VOXTOUCH_NUMBER(stiffness_cap_nm_per_rad),
                                       VOXTOUCH_NUMBER(injected_damping_ns_per_m),
                                       VOXTOUCH_NUMBER(injected_damping_nms_per_rad),
                                       VOXTOUCH_NUMBER(velocity_filter_hz),
                                       VOXTOUCH_NUMBER(slow_velocity_hz),
                                       VOXTOUCH_NUMBER(velocity_band_m_per_s),
                                       VOXTOUCH_NUMBER(damping_force_ratio),
                                       VOXTOUCH_NUMBER(damping_force_offset_n)};
#undef VOXTOUCH_NUMBER

std::vector<std::string> notes_on(const device_fit::FittedCoupling& fitted, double sample_time_s,
                                  const std::string& external) {
  std::vector<std::string> notes;
  if (!external.empty())
    notes.push_back(effects::no_certificate_sentence(external));
  if (!fitted.designed)
    notes.push_back(
        fitted.design.status == coupling::design::DesignStatus::kInfeasible
            ? "set by hand in the scene; not certified by the designer (see the reasons)"
            : "set by hand in the scene; certified by the designer");
  for (const std::string& more : design_text::damping_notes(fitted.design.spec))
    notes.push_back("injected damping " + more);
  if (const std::string forbids = design_text::out_of_reach(fitted.design.min_damping.out_of_reach);
      !forbids.empty())
    notes.push_back(fmt::format(
        "damping ratios of {:.2g} released and {:.2g} gripped are out of reach: {}",
        fitted.design.min_damping.released, fitted.design.min_damping.gripped, forbids));
  if (!fitted.refusal.empty())
    notes.push_back(design_text::sentence_of(fitted.refusal));
  for (const coupling::CouplingIssue& issue : coupling::validate(fitted.spec, {}, sample_time_s))
    notes.push_back(issue.sentence);
  return notes;
}

}  // namespace

std::string status_word(const device_fit::FittedCoupling& fitted) {
  return fitted.designed ? std::string(coupling::design::name_of(fitted.design.status))
                         : "configured";
}

void write_coupling(const Adoption& use, msg::CouplingDesign& m) {
  const coupling::CouplingSpec& spec = use.coupling.spec;
  m.session_id = use.session;
  m.from_sample = use.from_sample;
  m.starts_at_rest = use.starts_at_rest;
  m.commands_force = use.coupling.runs;
  m.kind = runtime::lend(spec.kind);
  for (const SpecNumber& one : kSpecNumbers)
    m.*one.of_message = spec.*one.of_spec;
  m.velocity_window = spec.velocity_window;
  m.max_force_n = use.coupling.limits.max_force_n;
  m.max_torque_nm = use.coupling.limits.max_torque_nm;
  m.resolution_m = use.coupling.limits.resolution_m;
  m.device_damping_ns_per_m = use.coupling.limits.damping_ns_per_m;
  m.device_coulomb_friction_n = use.coupling.limits.coulomb_friction_n;
  m.device_delay_s = use.coupling.limits.delay_s;
  m.device_force_lag_s = use.coupling.limits.force_lag_s;
  m.sample_time_s = use.sample_time_s;
}

Adoption adoption_of(const msg::CouplingDesign& m) {
  Adoption use{m.session_id, m.from_sample, m.starts_at_rest, {}, m.sample_time_s};
  use.coupling.runs = m.commands_force;
  use.coupling.spec.kind = m.kind ? m.kind : "";
  for (const SpecNumber& one : kSpecNumbers)
    use.coupling.spec.*one.of_spec = m.*one.of_message;
  use.coupling.spec.velocity_window = m.velocity_window;
  use.coupling.limits = {m.max_force_n,
                         m.max_torque_nm,
                         m.resolution_m,
                         m.device_damping_ns_per_m,
                         m.device_coulomb_friction_n,
                         m.device_delay_s,
                         m.device_force_lag_s};
  return use;
}

std::vector<std::string> differences(const AdoptedCoupling& recorded, const AdoptedCoupling& made) {
  std::vector<std::string> out;
  const auto compare = [&](std::string_view name, const auto& before, const auto& now, bool same) {
    if (!same)
      out.push_back(fmt::format("{} {} recorded, {} now", name, before, now));
  };
  const auto number = [&](std::string_view name, double before, double now) {
    compare(name, before, now,
            std::bit_cast<std::uint64_t>(before) == std::bit_cast<std::uint64_t>(now));
  };
  compare("kind", recorded.spec.kind, made.spec.kind, recorded.spec.kind == made.spec.kind);
  for (const SpecNumber& one : kSpecNumbers)
    number(one.name, recorded.spec.*one.of_spec, made.spec.*one.of_spec);
  compare("velocity_window", recorded.spec.velocity_window, made.spec.velocity_window,
          recorded.spec.velocity_window == made.spec.velocity_window);
  number("max_force_n", recorded.limits.max_force_n, made.limits.max_force_n);
  number("max_torque_nm", recorded.limits.max_torque_nm, made.limits.max_torque_nm);
  number("resolution_m", recorded.limits.resolution_m, made.limits.resolution_m);
  number("device_damping_ns_per_m", recorded.limits.damping_ns_per_m, made.limits.damping_ns_per_m);
  number("device_coulomb_friction_n", recorded.limits.coulomb_friction_n,
         made.limits.coulomb_friction_n);
  number("device_delay_s", recorded.limits.delay_s, made.limits.delay_s);
  number("device_force_lag_s", recorded.limits.force_lag_s, made.limits.force_lag_s);
  return out;
}

void publish_design(bus::Writer<msg::CouplingDesign>& writer,
                    const device_fit::FittedCoupling& fitted, const Adoption& use,
                    const std::string& external) {
  const coupling::design::Design& design = fitted.design;
  const std::string status = status_word(fitted);
  const std::vector<std::string> notes = notes_on(fitted, use.sample_time_s, external);
  const std::vector<std::string> reasons = design_text::reasons_of(design);
  const std::string worst_case = design_text::worst_case_of(design, 0);
  runtime::StringViews lent_notes(notes), lent_reasons(reasons);
  msg::CouplingDesign m{};
  write_coupling(use, m);
  m.status = runtime::lend(status);
  m.lag_s = coupling::lag_s(use.coupling.spec);
  m.requested_stiffness_n_per_m = design.translation.requested_stiffness;
  m.displayed_stiffness_n_per_m = design.translation.displayed_stiffness;
  m.critical_stiffness_n_per_m = design.translation.critical_stiffness;
  m.gain_margin = design.translation.gain_margin;
  m.limit_cycle_m = design.translation.limit_cycle_bound;
  m.displayed_stiffness_nm_per_rad = design.rotation.displayed_stiffness;
  m.critical_stiffness_nm_per_rad = design.rotation.critical_stiffness;
  m.max_approach_m_per_s = design.max_approach_m_per_s;
  m.released_damping_ratio = design.swing.released.ratio;
  m.gripped_damping_ratio = design.swing.gripped.ratio;
  m.released_min_damping_ratio = design.min_damping.released;
  m.gripped_min_damping_ratio = design.min_damping.gripped;
  m.min_damping_ratio_cost_n_per_m = design.min_damping.cost_n_per_m;
  m.passive = design.translation.passive;
  m.worst_case = runtime::lend(worst_case);
  lent_reasons.into(m.reasons);
  lent_notes.into(m.notes);
  writer.write(m);
}

}  // namespace voxtouch::coupling_node
