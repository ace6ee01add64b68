#include "nodes/cli/design/design_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/coupling/design/design_axis.hpp"
#include "core/coupling/design/design_cases.hpp"
#include "nodes/cli/design/certificate_report.hpp"
#include "nodes/cli/force_line.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::cli {
namespace {

constexpr double kPaperCutoffHz = 5.0;

coupling::design::LoopController paper_controller() {
  coupling::design::LoopController c;
  c.w0_rad_per_s = 2.0 * std::numbers::pi * kPaperCutoffHz;
  c.damping_ratio = 1.0;
  return c;
}

std::string range(double low, double high) {
  return low == high ? fmt::format("{:.3g}", low) : fmt::format("{:.3g} to {:.3g}", low, high);
}

std::string device_lines(const coupling::design::DeviceModel& d) {
  const coupling::design::AxisModel& a = d.translation;
  std::string text = fmt::format(
      "{} kg, {:.3g} Ns/m, {:.3g} N friction, encoder step {:.3g} mm, at most {:.3g} N and {:.4g} "
      "N/m",
      range(a.inertia_min, a.inertia_max), a.damping, a.coulomb_friction, a.resolution * 1e3,
      a.max_effort, a.max_stiffness);
  text += fmt::format(
      "\n"
      "                {:.4g} Hz, latency {:.3g} ms, jitter {:.0f} %, {} consecutive losses",
      1.0 / d.timing.period_s, d.timing.delay_s * 1e3, d.timing.jitter * 100,
      d.timing.consecutive_losses);
  return text;
}

std::string coupling_lines(const coupling::design::Design& design) {
  const coupling::CouplingSpec& s = design.spec;
  std::string text;
  if (s.kind == "shaping_filter")
    text = fmt::format(
        "shaping filter, {:.3g} Hz (w0 / 2 pi), damping ratio {:.3g}, gain {:.3g}; lag {:.2g} ms",
        s.cutoff_hz, s.damping_ratio, s.gain, design.lag_s * 1e3);
  else if (s.kind == "spring_damper")
    text = fmt::format("spring-damper, {:.4g} N/m and {:.3g} Ns/m", s.stiffness_n_per_m,
                       s.damping_ns_per_m);
  else
    text = fmt::format("direct, gain {:.3g}", s.gain);
  if (s.injected_damping_ns_per_m > 0)
    text += fmt::format(
        "\n"
        "                injected damping {:.3g} Ns/m in contact, velocity from {}",
        s.injected_damping_ns_per_m, design_text::text_of(coupling::design::velocity_of(s)));
  for (const std::string& more : design_text::damping_notes(s))
    text += ";\n                it " + more;
  if (std::isfinite(s.stiffness_cap_n_per_m))
    text += fmt::format("\n                contact capped at {:.4g} N/m", s.stiffness_cap_n_per_m);
  return text;
}

std::string axis_lines(const coupling::design::Design& design, std::size_t axis, const char* unit) {
  const coupling::design::AxisDesign& a = coupling::design::axis_of(design, axis);
  std::string text = fmt::format("{:.4g} {}, requested {:.4g}", a.displayed_stiffness, unit,
                                 a.requested_stiffness);
  if (std::isfinite(a.critical_stiffness))
    text +=
        fmt::format("; stability limit {:.4g}: {}\n                gain margin {:.3g}",
                    a.critical_stiffness, design_text::worst_case_of(design, axis), a.gain_margin);
  else
    text += "; stable at every stiffness";
  text += a.passive                  ? "; stable with any passive hand"
          : a.injected_damping > 0.0 ? "; certified for the hands above, not for any passive hand"
                                     : fmt::format("; with any passive hand only up to {:.3g} {}",
                                                   a.passive_stiffness, unit);
  return text;
}

/// Minimum damping ratios, if any, and their cost.
std::string damping_lines(const DesignReport& r) {
  namespace cd = coupling::design;
  const cd::DominantMode& least = r.design.swing;
  std::string text;
  for (const auto& [who, mode] :
       {std::pair("released", least.released), {"gripped", least.gripped}})
    if (const std::string where = design_text::case_of(mode); !where.empty())
      text += fmt::format("{}{:.2g} {} ({})", text.empty() ? "" : "\n                ", mode.ratio,
                          who, where);
  if (text.empty())
    return "no oscillating mode";
  const cd::MinDampingRatios& min_damping = r.problem.goals.min_damping;
  const bool kept = r.design.min_damping.released + r.design.min_damping.gripped > 0.0;
  if (min_damping.released + min_damping.gripped > 0.0)
    text += fmt::format("\n                minimum {:.2g} released and {:.2g} gripped: {}",
                        min_damping.released, min_damping.gripped, kept ? "kept" : "not kept");
  if (const std::string hand = design_text::out_of_reach(r.design.min_damping.out_of_reach);
      kept && !hand.empty())
    text += ", except where a hand makes it unreachable:\n                " + hand;
  return text;
}

std::string paper_line(const PaperRecipe& p) {
  const auto verdict = [&](const char* who, double critical) {
    if (std::isnan(critical))
      return std::string();
    return fmt::format("{} {} (limit {:.3g} N/m)", who,
                       p.stiffness < critical ? "stable" : "UNSTABLE", critical);
  };
  const std::string released = verdict("released", p.critical_released),
                    gripped = verdict("gripped", p.critical_gripped);
  return fmt::format("5 Hz, damping ratio 1, at {:.4g} N/m: {}{}{}", p.stiffness, released,
                     released.empty() || gripped.empty() ? "" : "; ", gripped);
}

std::string list(const char* title, const std::vector<std::string>& sentences) {
  if (sentences.empty())
    return "";
  std::string text = fmt::format("\n  {}\n", title);
  for (const std::string& s : sentences)
    text += "   - " + s + "\n";
  return text;
}

nlohmann::ordered_json finite(double v) {
  return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json();
}

/// A column of the stable region: its key in the JSON and the CSV. Infinite if every stiffness is
/// stable.
struct RegionColumn {
  const char* key;
  std::vector<double> values;
};

std::vector<RegionColumn> region_columns(const DesignReport& r) {
  std::vector<double> certified = r.region.critical;
  for (double& k : certified)
    k /= r.problem.goals.gain_margin;
  return {{"cutoff_hz", r.region.cutoff_hz},
          {"critical_n_per_m", r.region.critical},
          {"certified_n_per_m", certified},
          {"critical_undamped_n_per_m", r.region.critical_undamped},
          {"passive_n_per_m", r.region.passive}};
}

nlohmann::ordered_json region_json(const DesignReport& r) {
  nlohmann::ordered_json j{
      {"gain_margin", r.problem.goals.gain_margin},
      {"device_limit_n_per_m", finite(r.problem.device.translation.max_stiffness)}};
  for (const RegionColumn& column : region_columns(r)) {
    j[column.key] = nlohmann::ordered_json::array();
    for (const double value : column.values)
      j[column.key].push_back(finite(value));
  }
  if (r.law.x.empty())
    return j;
  nlohmann::ordered_json& law = j["law"] = {{"kind", r.design.spec.kind},
                                            {"over", r.law.over},
                                            {"unit", r.law.unit},
                                            {"chosen", r.law.chosen},
                                            {"x", r.law.x}};
  for (const double critical : r.law.critical) {
    law["critical_n_per_m"].push_back(finite(critical));
    law["certified_n_per_m"].push_back(finite(critical / r.problem.goals.gain_margin));
  }
  return j;
}

nlohmann::ordered_json axis_json(const coupling::design::Design& design, std::size_t axis) {
  const coupling::design::AxisDesign& a = coupling::design::axis_of(design, axis);
  return {{"requested_stiffness", finite(a.requested_stiffness)},
          {"displayed_stiffness", finite(a.displayed_stiffness)},
          {"critical_stiffness", finite(a.critical_stiffness)},
          {"gain_margin", finite(a.gain_margin)},
          {"worst_case", design_text::worst_case_of(design, axis)},
          {"passive", a.passive},
          {"passive_stiffness", finite(a.passive_stiffness)},
          {"spectral_radius", finite(a.spectral_radius)},
          {"limit_cycle_bound", finite(a.limit_cycle_bound)},
          {"damping_required", finite(a.damping_required)},
          {"injected_damping", a.injected_damping},
          {"velocity_filter_hz", a.velocity.filter_hz},
          {"velocity_window", a.velocity.window}};
}

}  // namespace

PaperRecipe judge_paper_recipe(const coupling::design::DesignProblem& problem) {
  PaperRecipe out;
  const coupling::design::AxisModel& axis = problem.device.translation;
  out.stiffness = std::min(problem.contact.all_points, axis.max_stiffness);
  out.critical_released = out.critical_gripped = std::numeric_limits<double>::quiet_NaN();
  for (const coupling::design::DesignCase& one :
       coupling::design::design_cases(axis, problem.device.timing, problem.hand.translation)) {
    const double critical =
        coupling::design::critical_stiffness(one.plant, paper_controller()).stiffness;
    double& worst = one.gripped ? out.critical_gripped : out.critical_released;
    worst = std::isnan(worst) ? critical : std::min(worst, critical);
  }
  return out;
}

coupling::design::StableRegion region_round(const coupling::design::DesignProblem& problem,
                                            const coupling::design::Design& design) {
  const coupling::design::DeviceModel& device = problem.device;
  coupling::design::LoopController chosen;
  chosen.damping_ratio = design.spec.damping_ratio;
  chosen.injected_damping = design.translation.injected_damping;
  chosen.use(design.translation.velocity);
  const double high_hz = std::max(20.0, 0.6 / (2.0 * std::numbers::pi * device.timing.period_s));
  return coupling::design::stable_region(device.translation, device.timing,
                                         problem.hand.translation, chosen, 1.0, high_hz, 64);
}

LawRegion region_of_law(const coupling::design::DesignProblem& problem,
                        const coupling::design::Design& design) {
  namespace cd = coupling::design;
  constexpr int kCount = 64;
  cd::AxisProblem axis = cd::axis_problems(problem).front();
  axis.damping_force_ratio =
      design.spec.damping_force_ratio;  // the design may omit a requested bound
  cd::LoopController law = cd::controller_of(design.spec, axis, cd::arm_squared(problem));
  const double cap = design.spec.stiffness_cap_n_per_m,
               contact = std::min(problem.contact.all_points, cap);
  const bool spring = law.law == cd::LoopController::Law::kSpringDamper;
  LawRegion out;
  if (law.law == cd::LoopController::Law::kShapingFilter || (spring && law.stiffness <= 0.0))
    return out;
  out.over = spring ? "damper over spring" : "injected damping";
  out.unit = spring ? "s" : "Ns/m";
  out.chosen = spring ? law.damping / law.stiffness : law.injected_damping;
  const double middle = out.chosen > 0.0 ? out.chosen : 1.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = middle * std::pow(10.0, 2.0 * i / (kCount - 1) - 1.0);
    (spring ? law.damping : law.injected_damping) = spring ? x * law.stiffness : x;
    double critical =
        spring
            ? cd::critical_scale(axis, law, std::isfinite(cap) ? contact : cd::kInfinity).stiffness
            : cd::critical_case(axis, law).stiffness;
    if (axis.hand.any_passive)
      critical = std::min(critical, cd::passive_limit(axis, law));
    if (spring)
      critical *= law.stiffness * contact /
                  (law.stiffness + contact);  // a factor on the displayed stiffness
    out.x.push_back(x);
    out.critical.push_back(critical);
  }
  return out;
}

std::string to_text(const DesignReport& r) {
  const coupling::design::Design& d = r.design;
  std::string text = fmt::format("\n  {}: {}\n\n", coupling::design::name_of(d.status),
                                 design_text::sentence_of(coupling::design::name_of(d.status)));
  const auto row = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<13} {}\n", name, value);
  };
  row("device", r.device);
  text += fmt::format("                {}\n", device_lines(r.problem.device));
  row("hand", r.hand);
  row("contact", r.contact);
  row("coupling", coupling_lines(d));
  row("stiffness", axis_lines(d, 0, "N/m"));
  if (r.preview)
    if (const std::string line = contact_line(*r.preview, r.device); !line.empty())
      row("at the tool", line);
  if (r.problem.device.gives_torque)
    row("rotation", axis_lines(d, 1, "Nm/rad"));
  if (const std::string line = certificate_line(r.certificate); !line.empty())
    row("certificate", line);
  row("damping", damping_lines(r));
  row("encoder",
      d.translation.limit_cycle_bound > 0
          ? fmt::format("quantisation may cause a limit cycle of up to {:.3g} mm peak to peak",
                        d.translation.limit_cycle_bound * 1e3)
          : "friction suppresses limit cycles of quantisation");
  if (d.max_approach_m_per_s > 0)
    row("approach", fmt::format("up to {:.2g} m/s stays within the contact layer ({:.2g} mm); a "
                                "faster hand moves deeper and is stopped there",
                                d.max_approach_m_per_s, r.problem.goals.force_layer_depth_m * 1e3));
  row("paper", paper_line(r.paper));
  return text + list("Limits:", design_text::reasons_of(d)) +
         list("Not covered by the certificate:", certificate_gaps(r.certificate));
}

nlohmann::ordered_json to_json(const DesignReport& r) {
  const coupling::CouplingSpec& s = r.design.spec;
  nlohmann::ordered_json j;
  j["ok"] = r.design.status != coupling::design::DesignStatus::kInfeasible;
  j["status"] = std::string(coupling::design::name_of(r.design.status));
  j["device"] = r.device;
  j["hand"] = r.hand;
  j["contact"] = r.contact;
  j["coupling"] = {{"kind", s.kind},
                   {"cutoff_hz", s.cutoff_hz},
                   {"damping_ratio", s.damping_ratio},
                   {"gain", s.gain},
                   {"stiffness_n_per_m", s.stiffness_n_per_m},
                   {"damping_ns_per_m", s.damping_ns_per_m},
                   {"injected_damping_ns_per_m", s.injected_damping_ns_per_m},
                   {"injected_damping_nms_per_rad", s.injected_damping_nms_per_rad},
                   {"velocity_filter_hz", s.velocity_filter_hz},
                   {"velocity_window", s.velocity_window},
                   {"slow_velocity_hz", s.slow_velocity_hz},
                   {"velocity_band_m_per_s", s.velocity_band_m_per_s},
                   {"damping_force_ratio", s.damping_force_ratio},
                   {"damping_force_offset_n", s.damping_force_offset_n}};
  if (std::isfinite(s.stiffness_cap_n_per_m))
    j["coupling"]["stiffness_cap_n_per_m"] = s.stiffness_cap_n_per_m;
  if (std::isfinite(s.stiffness_cap_nm_per_rad))
    j["coupling"]["stiffness_cap_nm_per_rad"] = s.stiffness_cap_nm_per_rad;
  j["at_the_tool"] = nullptr;
  if (r.preview)
    j["at_the_tool"] = {{"reach_m", r.preview->reach_m},
                        {"along_n_per_m", r.preview->stiffness_n_per_m},
                        {"across_n_per_m", r.preview->across_n_per_m()}};
  j["lag_s"] = r.design.lag_s;
  j["max_approach_m_per_s"] = r.design.max_approach_m_per_s;
  j["translation"] = axis_json(r.design, 0);
  if (r.problem.device.gives_torque)
    j["rotation"] = axis_json(r.design, 1);
  const coupling::design::DominantMode& swing = r.design.swing;
  const coupling::design::MinDampingResult& min_damping = r.design.min_damping;
  j["dominant_mode"] = {
      {"released_damping_ratio", swing.released.ratio},
      {"released", design_text::case_of(swing.released)},
      {"gripped_damping_ratio", swing.gripped.ratio},
      {"gripped", design_text::case_of(swing.gripped)},
      {"released_min_damping_ratio", r.problem.goals.min_damping.released},
      {"gripped_min_damping_ratio", r.problem.goals.min_damping.gripped},
      {"min_damping_ratio_kept", min_damping.released + min_damping.gripped > 0.0},
      {"out_of_reach", design_text::out_of_reach(min_damping.out_of_reach)},
      {"min_damping_ratio_cost_n_per_m", min_damping.cost_n_per_m},
      {"min_damping_ratio_cost_nm_per_rad", min_damping.cost_nm_per_rad}};
  j["paper_recipe"] = {{"cutoff_hz", kPaperCutoffHz},
                       {"damping_ratio", 1.0},
                       {"stiffness_n_per_m", r.paper.stiffness}};
  const auto verdict = [&](const char* who, double critical) {
    if (!std::isnan(critical))
      j["paper_recipe"][who] = {{"stable", r.paper.stiffness < critical},
                                {"critical_stiffness", critical}};
  };
  verdict("released", r.paper.critical_released);
  verdict("gripped", r.paper.critical_gripped);
  j["certificate"] = certificate_json(r.certificate);
  j["reasons"] = design_text::reasons_of(r.design);
  j["region"] = region_json(r);
  return j;
}

std::string to_csv(const DesignReport& report) {
  const std::vector<RegionColumn> columns = region_columns(report);
  std::string text;
  for (const RegionColumn& column : columns)
    text += fmt::format("{}{}", text.empty() ? "" : ",", column.key);
  for (std::size_t row = 0; row < report.region.cutoff_hz.size(); ++row) {
    text += '\n';
    for (const RegionColumn& column : columns) {
      if (&column != &columns.front())
        text += ',';
      if (std::isfinite(column.values[row]))
        text += fmt::format("{}", column.values[row]);
    }
  }
  return text + '\n';
}

}  // namespace voxtouch::cli
