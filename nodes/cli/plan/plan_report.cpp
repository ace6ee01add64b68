#include "nodes/cli/plan/plan_report.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/accuracy/tool_row.hpp"

namespace voxtouch::cli {
namespace {

const PartTime* time_of(const PlanReport& report, const std::string& part) {
  if (!report.times)
    return nullptr;
  for (const PartTime& time : report.times->parts)
    if (time.part == part)
      return &time;
  return nullptr;
}

bool of_the_ring(const rendering::PlanPart& part) {
  return part.name.starts_with("topic ") || part.name.starts_with("node ");
}

std::string ns_text(double ns) { return ns > 0.0 ? fmt::format("{:.0f}", ns) : "-"; }

/// A part without a separate time refers to the part that includes it.
std::string measured_text(const PlanReport& report, const rendering::PlanPart& part) {
  if (const PartTime* time = time_of(report, part.name))
    return fmt::format("{:.0f}", time->measured_ns);
  if (!report.times)
    return "";
  if (part.name == "voxmap" || part.name == "culling tree")
    return "(pointshell)";
  if (report.times->slides &&
      (part.name.starts_with("contact model ") || part.name == "sharp edges"))
    return "(virtual tool)";
  if (part.name == "distance field")
    return report.times->slides ? "(virtual tool)" : "(contact)";
  return "-";
}

std::string frame_rows(const PlanReport& report) {
  std::size_t width = 4;
  for (const rendering::PlanPart& part : report.plan.parts)
    if (!of_the_ring(part))
      width = std::max(width, part.name.size());
  std::string text = fmt::format("  {:<{}} {:>10} {:>11} {:>11} {:>14}  why\n", "part", width,
                                 "bytes", "at most ns", "expected ns", "measured ns");
  for (const rendering::PlanPart& part : report.plan.parts) {
    if (of_the_ring(part))
      continue;
    const PartTime* time = time_of(report, part.name);
    text += fmt::format("  {:<{}} {:>10} {:>11} {:>11} {:>14}  {}\n", part.name, width,
                        part.bytes > 0 ? rendering::bytes_text(part.bytes) : "-",
                        ns_text(part.expected_ns), time ? ns_text(time->expected_ns) : "",
                        measured_text(report, part), part.why);
  }
  return text;
}

std::string ring_rows(const PlanReport& report) {
  std::size_t width = 4;
  for (const rendering::PlanPart& part : report.plan.parts)
    if (of_the_ring(part))
      width = std::max(width, part.name.size());
  std::string text;
  for (const rendering::PlanPart& part : report.plan.parts)
    if (of_the_ring(part))
      text += fmt::format("  {:<{}} {:<10}  {}\n", part.name, width, part.node, part.why);
  return text;
}

std::string section(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty())
    return "";
  std::string text = fmt::format("\n{}\n", title);
  for (const std::string& line : lines)
    text += fmt::format("  - {}\n", line);
  return text;
}

std::string times_text(const PlanReport& report) {
  if (!report.times)
    return "";
  const PlanTimes& t = *report.times;
  std::string text = fmt::format(
      "  Measured frame {}: {:.0f} ns (median), {:.0f} ns (95 %), {:.0f} ns (worst); out of "
      "contact: {}.\n"
      "  In contact: {} of {} frames {}. {}: {:.0f}; in contact: {:.0f} (medians).\n"
      "  CPU time of one thread with warm caches, without DDS; {}; load {:.1f}: compare ratios "
      "only.\n",
      t.touching > 0 ? "in contact" : "out of contact", t.frame_median_ns, t.frame_p95_ns,
      t.frame_worst_ns, t.frame_free_ns > 0.0 ? fmt::format("{:.0f} ns", t.frame_free_ns) : "never",
      t.touching, t.frames,
      t.along.empty() ? "at seeded places on the surface" : fmt::format("along '{}'", t.along),
      t.slides ? "Pairs of features near each other"
               : fmt::format("Points of {} after culling", report.plan.shell_points),
      t.points_tested, t.hits, report.machine.processor, report.load);
  if (t.slides)
    text += fmt::format(
        "  Virtual tool: the hand slides {:g} e a frame sideways from each place, {:.2f} queries a "
        "frame on average.\n"
        "  At rest, or pushing straight in, no query is needed.\n",
        accuracy::kSlideEdges, t.queries_per_frame);
  if (!report.no_coupling_time_reason.empty())
    text += fmt::format("  {}\n", report.no_coupling_time_reason);
  return text;
}

nlohmann::ordered_json part_json(const PlanReport& report, const rendering::PlanPart& part) {
  nlohmann::ordered_json j{{"name", part.name},
                           {"node", part.node},
                           {"why", part.why},
                           {"bytes", part.bytes},
                           {"at_most_ns", part.expected_ns}};
  const PartTime* time = time_of(report, part.name);
  j["expected_ns"] = time ? nlohmann::ordered_json(time->expected_ns) : nlohmann::ordered_json();
  j["measured_ns"] = time ? nlohmann::ordered_json(time->measured_ns) : nlohmann::ordered_json();
  return j;
}

}  // namespace

std::string to_text(const PlanReport& report) {
  const rendering::Plan& plan = report.plan;
  std::uint64_t bytes = 0;
  for (const rendering::PlanPart& part : plan.parts)
    bytes += part.bytes;
  // First the request: what is built and why, and whether the device can run it. General facts come
  // last.
  std::string text = fmt::format("Scene {} ({})\n", plan.scene, plan.scene_hash);
  text += section("Built", plan.built) + section("Warnings", plan.warnings);
  if (report.device) {
    text += section(fmt::format("{} cannot run this scene", report.device->device).c_str(),
                    report.device->errors);
    text += section(fmt::format("On {}", report.device->device).c_str(), report.device->notes);
  }
  text += "\nCost of a frame\n" + frame_rows(report);
  text += fmt::format("  All parts: {}; at most about {:.1f} us per frame.\n",
                      rendering::bytes_text(bytes), plan.expected_ns_per_frame / 1e3);
  text += times_text(report);
  return text + section("Not built", plan.skipped) + "\nTopics and nodes\n" + ring_rows(report);
}

nlohmann::ordered_json to_json(const PlanReport& report) {
  const rendering::Plan& plan = report.plan;
  nlohmann::ordered_json j{{"ok", !report.device || report.device->errors.empty()},
                           {"scene", plan.scene},
                           {"scene_hash", plan.scene_hash},
                           {"contact_model", plan.contact_model},
                           {"voxel_size_m", plan.voxel_size_m},
                           {"shell_points", plan.shell_points},
                           {"surface_voxels", plan.surface_voxels},
                           {"interior_voxels", plan.interior_voxels},
                           {"bytes", plan.bytes},
                           {"at_most_ns_per_frame", plan.expected_ns_per_frame}};
  j["parts"] = nlohmann::ordered_json::array();
  for (const rendering::PlanPart& part : plan.parts)
    j["parts"].push_back(part_json(report, part));
  j["built"] = plan.built, j["skipped"] = plan.skipped, j["warnings"] = plan.warnings;
  j["measured"] = nullptr;
  if (report.times) {
    const PlanTimes& t = *report.times;
    j["measured"] = {
        {"along", t.along.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(t.along)},
        {"frames", t.frames},
        {"touching", t.touching},
        {"points_tested", t.points_tested},
        {"hits", t.hits},
        {"queries_per_frame", t.queries_per_frame},
        {"frame_median_ns", t.frame_median_ns},
        {"frame_p95_ns", t.frame_p95_ns},
        {"frame_worst_ns", t.frame_worst_ns},
        {"frame_free_ns", t.frame_free_ns},
        {"processor", report.machine.processor},
        {"load", report.load}};
  }
  j["device"] = nullptr;
  if (report.device)
    j["device"] = {{"name", report.device->device},
                   {"errors", report.device->errors},
                   {"notes", report.device->notes}};
  return j;
}

}  // namespace voxtouch::cli
