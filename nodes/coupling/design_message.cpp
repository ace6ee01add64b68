#include "nodes/coupling/design_message.hpp"

#include <fmt/format.h>

#include "nodes/runtime/strings.hpp"

namespace voxtouch::coupling_node {
namespace {

std::vector<std::string> notes_on(const fitting::FittedCoupling& fitted, double sample_time_s,
                                  const std::string& external) {
  std::vector<std::string> notes;
  if (!external.empty())
    notes.push_back(effects::no_certificate_sentence(external));
  if (!fitted.designed)
    notes.push_back(
        fitted.design.status == coupling::design::DesignStatus::kInfeasible
            ? "set by hand in the scene; the designer does not vouch for it: the reasons say why"
            : "set by hand in the scene; the designer's certificates hold for it");
  for (const std::string& more : {coupling::design::describe_slow_velocity(fitted.design.spec),
                                  coupling::design::describe_bound(fitted.design.spec)})
    if (!more.empty())
      notes.push_back("injected damping " + more);
  if (const std::string& forbids = fitted.design.floors.out_of_reach; !forbids.empty())
    notes.push_back(
        fmt::format("a damping ratio of {:.2g} released and {:.2g} held is out of reach: {}",
                    fitted.design.floors.released, fitted.design.floors.held, forbids));
  if (!fitted.refusal.empty())
    notes.push_back(fitted.refusal);
  for (const coupling::CouplingIssue& issue : coupling::validate(fitted.spec, {}, sample_time_s))
    notes.push_back(issue.sentence);
  return notes;
}

}  // namespace

std::string status_word(const fitting::FittedCoupling& fitted) {
  return fitted.designed ? std::string(coupling::design::name_of(fitted.design.status))
                         : "configured";
}

msg::CouplingDesign design_numbers(const fitting::FittedCoupling& fitted, double sample_time_s) {
  const coupling::CouplingSpec& spec = fitted.spec;
  const coupling::design::Design& design = fitted.design;
  const bool filter = spec.kind == "shaping_filter", spring = spec.kind == "spring_damper";
  msg::CouplingDesign m{};
  m.cutoff_hz = filter ? spec.cutoff_hz : 0.0;
  m.damping_ratio = filter ? spec.damping_ratio : 0.0;
  m.gain = spring ? 1.0 : spec.gain;
  m.stiffness_n_per_m = spring ? spec.stiffness_n_per_m : 0.0;
  m.damping_ns_per_m = spring ? spec.damping_ns_per_m : 0.0;
  m.stiffness_cap_n_per_m = spec.stiffness_cap_n_per_m;
  m.stiffness_cap_nm_per_rad = spec.stiffness_cap_nm_per_rad;
  m.injected_damping_ns_per_m = spec.injected_damping_ns_per_m;
  m.injected_damping_nms_per_rad = spec.injected_damping_nms_per_rad;
  m.velocity_filter_hz = spec.velocity_filter_hz;
  m.velocity_window = spec.velocity_window;
  m.lag_s = coupling::lag_s(spec);
  m.sample_time_s = sample_time_s;
  m.wanted_stiffness_n_per_m = design.translation.wanted_stiffness;
  m.shown_stiffness_n_per_m = design.translation.shown_stiffness;
  m.critical_stiffness_n_per_m = design.translation.critical_stiffness;
  m.gain_margin = design.translation.gain_margin;
  m.limit_cycle_m = design.translation.limit_cycle_bound;
  m.shown_stiffness_nm_per_rad = design.rotation.shown_stiffness;
  m.critical_stiffness_nm_per_rad = design.rotation.critical_stiffness;
  m.max_approach_m_per_s = design.max_approach_m_per_s;
  m.released_damping_ratio = design.swing.released;
  m.held_damping_ratio = design.swing.held;
  m.released_damping_floor = design.floors.released;
  m.held_damping_floor = design.floors.held;
  m.damping_floor_cost_n_per_m = design.floors.cost_n_per_m;
  m.passive = design.translation.passive;
  return m;
}

void publish_design(bus::Writer<msg::CouplingDesign>& writer, const fitting::FittedCoupling& fitted,
                    std::uint64_t session, double sample_time_s, const std::string& external) {
  const coupling::design::Design& design = fitted.design;
  const std::string status = status_word(fitted);
  const std::vector<std::string> notes = notes_on(fitted, sample_time_s, external);
  runtime::LentStrings lent_notes(notes), reasons(design.reasons), remedies(design.remedies);
  msg::CouplingDesign m = design_numbers(fitted, sample_time_s);
  m.session_id = session;
  m.kind = runtime::lend(fitted.spec.kind);
  m.status = runtime::lend(status);
  m.worst_case = runtime::lend(design.translation.worst_case_text);
  reasons.into(m.reasons);
  remedies.into(m.remedies);
  lent_notes.into(m.notes);
  writer.write(m);
}

}  // namespace voxtouch::coupling_node
