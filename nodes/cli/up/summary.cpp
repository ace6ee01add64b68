#include "nodes/cli/up/summary.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "nodes/cli/up/figure_table.hpp"
#include "nodes/cli/up/verdict_text.hpp"
#include "nodes/design_text/design_text.hpp"

namespace voxtouch::cli {

double number(const Reports& reports, const std::string& node, const std::string& name) {
  const auto report = reports.find(node);
  return report == reports.end() ? 0.0 : runtime::value_of(report->second.figures, name);
}

std::string word(const Reports& reports, const std::string& node, const std::string& key) {
  const auto report = reports.find(node);
  if (report == reports.end())
    return "";
  const auto value = report->second.values.find(key);
  return value == report->second.values.end() ? "" : value->second;
}

bool has_virtual_tool(const RunRecord& run) {
  return number(run.reports, "rendering", "spring_n_per_m") > 0.0;
}

bool measures_latency(const RunRecord& run) { return run.mode != "lockstep"; }

namespace {

std::uint64_t count(const Reports& reports, const std::string& node, const std::string& name) {
  return runtime::as_count(number(reports, node, name));
}

using Names = std::initializer_list<const char*>;

/// Figures of a node under their names; counts as whole numbers.
void add_counts(nlohmann::ordered_json& j, const Reports& r, const char* node, Names names) {
  for (const char* name : names)
    j[name] = count(r, node, name);
}
void add_numbers(nlohmann::ordered_json& j, const Reports& r, const char* node, Names names) {
  for (const char* name : names)
    j[name] = number(r, node, name);
}

nlohmann::ordered_json coupling_json(const Reports& r) {
  nlohmann::ordered_json j;
  j["status"] = word(r, "coupling", "design_status");
  j["kind"] = word(r, "coupling", "design_kind");
  for (const char* name : {"cutoff_hz", "gain", "injected_damping_ns_per_m"})
    j[name] = number(r, "coupling", std::string("design_") + name);
  j["displayed_stiffness_n_per_m"] = number(r, "coupling", "design_displayed_n_per_m");
  j["critical_stiffness_n_per_m"] = number(r, "coupling", "design_critical_n_per_m");
  j["gain_margin"] = number(r, "coupling", "design_gain_margin");
  j["worst_case"] = word(r, "coupling", "design_worst_case");
  add_counts(j, r, "coupling", {"designs", "capped_samples", "bounded_samples", "swings"});
  add_numbers(j, r, "coupling",
              {"swing_hz", "swing_m", "swing_n", "swing_s", "lowest_energy_j",
               "lowest_energy_rotation_j", "energy_bound_j", "energy_bound_rotation_j"});
  return j;
}

/// Figures of optional parts of a scene: a virtual tool, an external wrench.
void add_scene_facts(nlohmann::ordered_json& j, const RunSummary& s) {
  const Reports& r = s.reports;
  if (has_virtual_tool(s)) {
    add_numbers(j["virtual_tool"], r, "rendering", {"spring_n_per_m", "most_residual_m"});
    add_counts(j["virtual_tool"], r, "rendering",
               {"samples_at_work_limit", "not_converged_samples", "not_initialised_samples"});
  }
  if (!word(r, "rendering", "external").empty()) {
    j["external"] = {{"topic", word(r, "rendering", "external_topic")},
                     {"writer", word(r, "rendering", "external_writer")}};
    add_counts(j["external"], r, "rendering",
               {"external_samples", "external_foreign", "external_not_finite",
                "external_wrong_frame", "external_late"});
    add_numbers(j["external"], r, "rendering", {"external_energy_generated_j"});
  }
}

void add_recording(nlohmann::ordered_json& j, const Reports& r) {
  add_counts(j, r, "logger", {"written", "dropped", "refused_records", "skipped_messages"});
  for (const char* stream : {"device_state", "rendering_contact", "coupling_command"})
    j["streams"][stream] = {{"recorded", count(r, "logger", stream + std::string("_recorded"))},
                            {"gaps", count(r, "logger", stream + std::string("_gaps"))}};
}

}  // namespace

nlohmann::ordered_json to_json(const RunSummary& s) {
  const Reports& r = s.reports;
  nlohmann::ordered_json j;
  j["ok"] = s.verdict.passed();
  j["verdict"] = verdict_line(s, s.verdict);
  j["scene"] = s.scene;
  j["device"] = s.device;
  j["motion"] = s.motion;
  j["mode"] = s.mode;
  j["seed"] = s.seed;
  j["samples"] = count(r, "device", "samples");
  j["rate_hz"] = number(r, "device", "rate_hz");
  for (const char* quantile : {"p50", "p99", "max"})
    j["ring_latency_us"][quantile] =
        measures_latency(s)
            ? nlohmann::ordered_json(number(r, "device", fmt::format("latency_{}_us", quantile)))
            : nlohmann::ordered_json();
  add_counts(j, r, "device", {"answered", "overruns", "deadline_misses"});
  add_counts(j, r, "rendering",
             {"contact_samples", "latched_samples", "saturated_samples", "fast_samples",
              "tunnelling_suspected_samples", "passed_through_samples"});
  add_scene_facts(j, s);
  add_counts(j, r, "device", {"zero_force_samples", "interruptions", "force_losses"});
  add_numbers(j, r, "device", {"force_lost_s"});
  j["max_force_n"] = number(r, "device", "max_force_n");
  j["coupling"] = coupling_json(r);
  add_counts(j["guard"], r, "device", {"refused", "refused_late", "clamped", "slewed"});
  add_counts(j["validator"], r, "validator",
             {"checked", "skipped", "compared", "decided", "agree", "in_band", "disagree"});
  add_recording(j["recording"], r);
  for (const CheckedLimit& judged : s.verdict.limits)
    j["limits"][std::string(judged.limit->name)] = {
        {"value", judged.measured ? nlohmann::ordered_json(*judged.measured) : nullptr},
        {judged.limit->at_least ? "at_least" : "at_most", judged.bound},
        {"unit", judged.limit->unit},
        {"met", judged.met}};
  for (const Restart& restart : s.restarts)
    j["restarts"].push_back({{"node", restart.node},
                             {"ended_by", restart.how},
                             {"after_samples", runtime::as_count(restart.at_sample)},
                             {"started_again", restart.is_done}});
  j["bag"] = s.bag.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(s.bag);
  j["problems"] = problems_of(s, s.verdict);
  j["notes"] = notes_of(s, s.verdict);
  return j;
}

std::string to_text(const RunSummary& s) {
  std::string text = "\n  " + verdict_line(s, s.verdict) + "\n";
  for (const std::string& problem : problems_of(s, s.verdict))
    text += "  PROBLEM     " + problem + "\n";
  if (count(s.reports, "device", "samples") > 0)
    text += figure_table(s, s.verdict);
  const std::string design = word(s.reports, "coupling", "design_status");
  if (const std::string_view means = design_text::sentence_of(design); !means.empty())
    text += fmt::format("  coupling    {}\n", means);
  if (!s.bag.empty())
    text +=
        fmt::format("  bag         {} ({} messages, {} dropped)\n", s.bag,
                    count(s.reports, "logger", "written"), count(s.reports, "logger", "dropped"));
  for (const std::string& note : notes_of(s, s.verdict))
    text += "  NOTE        " + note + "\n";
  return text;
}

std::string status_line(const Reports& r, const std::vector<std::string>& nodes) {
  const auto device = r.find("device");
  std::string silent, unready;
  const auto add = [](std::string& to, const std::string& node) {
    to += (to.empty() ? "" : ", ") + node;
  };
  for (const std::string& node : nodes)
    if (const auto report = r.find(node); report == r.end())
      add(silent, node);
    else if (device == r.end() ? report->second.state == runtime::NodeState::kStarting
                               : report->second.session_id == 0)
      add(unready, node);
  const std::string& waiting =
      silent.empty() ? unready : silent;  // the silent nodes come first: the others wait for them
  const bool starts = device == r.end() || device->second.state == runtime::NodeState::kStarting;
  if (starts || (!waiting.empty() && count(r, "device", "samples") == 0))
    return "starting: waiting for " +
           (waiting.empty() ? "the device" : waiting);  // in lockstep a ready device waits too
  const double p50_us = number(r, "device", "latency_p50_us");
  const std::string latency = p50_us > 0.0
                                  ? fmt::format("latency p50 {:>4.0f} us p99 {:>5.0f} us", p50_us,
                                                number(r, "device", "latency_p99_us"))
                                  : "latency not measured";
  return fmt::format(
      "{:>7} samples  force {:6.2f} N at most  answered {:5.1f} %  {}  overruns {}  "
      "contacts {}  validator {}/{} agree",
      count(r, "device", "samples"), number(r, "device", "last_second_max_force_n"),
      100.0 * number(r, "device", "last_second_answered_ratio"), latency,
      count(r, "device", "overruns"), count(r, "rendering", "contact_samples"),
      count(r, "validator", "agree"), count(r, "validator", "decided"));
}

}  // namespace voxtouch::cli
