#include "nodes/replay/replay_report.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

namespace voxtouch::replay {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMaxFields = 8;  ///< that are printed; JSON has all

template <class T>
std::string difference_text(std::string_view what, const Comparison<T>& c) {
  if (c.compared == 0)
    return fmt::format("  {:<9} no sample could be compared\n", what);
  if (c.differ == 0)
    return fmt::format("  {:<9} {} samples compared, all bit-identical\n", what, c.compared);
  std::string text = fmt::format(
      "  {:<9} {} of {} samples differ, first sample {}; largest difference {:.3g} N (sample {}), "
      "{:.3g} Nm (sample {})\n",
      what, c.differ, c.compared, c.first->sequence_number, c.force_n.value, c.force_n.sample,
      c.torque_nm.value, c.torque_nm.sample);
  for (std::size_t i = 0; i < std::min(c.fields.size(), kMaxFields); ++i)
    text += fmt::format("            {}: {} recorded, {} now, by {}\n", c.fields[i].field,
                        c.fields[i].recorded, c.fields[i].replayed, c.fields[i].by);
  if (c.fields.size() > kMaxFields)
    text += fmt::format("            and {} more fields\n", c.fields.size() - kMaxFields);
  return text;
}

std::string forces_text(std::string_view what, const ForcesCompared& statistics) {
  const auto row = [](const ForceStatistics& f) {
    return fmt::format("{:8.3f} {:8.3f} {:8.1f} %", f.most_n, f.rms_n(), 100.0 * f.fraction());
  };
  return fmt::format("  {:<9}{}   {}\n", what, row(statistics.recorded), row(statistics.replayed));
}

std::string scene_text(const Replayed& r) {
  if (r.same_scene())
    return fmt::format("scene '{}'", r.recorded.name);
  if (r.recorded.hash.empty())
    return fmt::format("scene '{}' (the recorded scene is unknown)", r.replayed.name);
  return fmt::format("different scene: '{}' ({}) instead of '{}' ({})", r.replayed.name,
                     r.replayed.hash, r.recorded.name, r.recorded.hash);
}

/// JSON has no NaN and no infinity.
ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

template <class T>
ordered_json to_json(const Comparison<T>& c) {
  ordered_json fields = ordered_json::array();
  for (const FieldDifference& f : c.fields)
    fields.push_back(
        {{"field", f.field}, {"recorded", f.recorded}, {"replayed", f.replayed}, {"by", f.by}});
  const auto most = [](const auto& m, const char* unit) {
    return ordered_json{{unit, number(m.value)}, {"sample", m.sample}};
  };
  return {{"compared", c.compared},
          {"differ", c.differ},
          {"first", c.first ? ordered_json{{"sample", c.first->sequence_number},
                                           {"session", c.first->session_id},
                                           {"fields", fields}}
                            : ordered_json(nullptr)},
          {"largest_force", most(c.force_n, "n")},
          {"largest_torque", most(c.torque_nm, "nm")}};
}

ordered_json to_json(const ForceStatistics& f) {
  return {{"largest_n", number(f.most_n)},
          {"rms_n", number(f.rms_n())},
          {"in_contact_ratio", f.fraction()}};
}
ordered_json to_json(const ForcesCompared& f) {
  return {{"recorded", to_json(f.recorded)}, {"replayed", to_json(f.replayed)}};
}
ordered_json to_json(const SceneName& s) {
  return {{"name", s.name}, {"hash", s.hash}, {"file", s.file}};
}

ordered_json to_json(const ForceCurves& c) {
  const auto numbers = [](const std::vector<double>& values) {
    ordered_json all = ordered_json::array();
    for (const double value : values)
      all.push_back(number(value));
    return all;
  };
  return {{"t_s", numbers(c.t_s)},
          {"recorded_n", numbers(c.recorded_n)},
          {"replayed_n", numbers(c.replayed_n)}};
}

}  // namespace

std::string to_text(const Replayed& r) {
  std::string text = fmt::format(
      "{}: {}, {}, {}, {} samples in {:.3f} s of device time\n",
      std::filesystem::path(r.bag).lexically_normal().filename().string(), scene_text(r), r.device,
      r.lockstep ? "lockstep" : "real time", r.samples, r.duration_s);
  if (!r.other_build.empty())
    text += fmt::format("  recorded: replay of {}; replayed and now: replay of this build\n",
                        r.other_build);
  if (r.skipped > 0)
    text += fmt::format("  {} samples had no reply in the recording and are skipped\n", r.skipped);
  if (r.changes > 0)
    text += fmt::format("  {} changes replayed\n", r.changes);
  if (r.lost_states + r.lost_contacts > 0)
    text += fmt::format("  not recorded: {} device samples and {} contacts with recorded replies\n",
                        r.lost_states, r.lost_contacts);
  text += difference_text("contact", r.contact) + difference_text("command", r.command);
  if (r.designs_differ > 0)
    text += fmt::format("  {:<9} {} of {} differ from the designs of this build\n", "design",
                        r.designs_differ, r.designs);
  if (!r.equal() || !r.same_scene()) {
    text += "  force [N]      recorded                        replayed\n";
    text += "             largest      rms  in contact    largest      rms  in contact\n";
    text += forces_text("rendered", r.rendered) + forces_text("returned", r.returned);
  }
  for (const std::string& note : r.notes)
    text += "  note: " + note + "\n";
  for (const std::string& what : r.missing)
    text += "  missing: " + what + "\n";
  for (const std::string& loss : r.losses)
    text += "  lost: " + loss + "\n";
  text += r.contact.compared + r.command.compared == 0 ? "  FAILED: nothing to compare.\n"
          : r.passed()                                 ? "  PASSED: bit-identical.\n"
          : r.losses.empty() && !r.equal()             ? "  FAILED: the replay differs.\n"
                                                       : "  FAILED: the recording is incomplete.\n";
  return text;
}

ordered_json to_json(const Replayed& r) {
  return {{"ok", r.passed()},
          {"bag", r.bag},
          {"other_build", r.other_build},
          {"rig", r.rig},
          {"device", r.device},
          {"lockstep", r.lockstep},
          {"scene",
           {{"same", r.same_scene()},
            {"recorded", to_json(r.recorded)},
            {"replayed", to_json(r.replayed)}}},
          {"duration_s", r.duration_s},
          {"sessions", r.sessions},
          {"samples", r.samples},
          {"skipped", r.skipped},
          {"changes", r.changes},
          {"lost", {{"device_state", r.lost_states}, {"contact_state", r.lost_contacts}}},
          {"contact", to_json(r.contact)},
          {"command", to_json(r.command)},
          {"design", {{"compared", r.designs}, {"differ", r.designs_differ}}},
          {"forces", {{"rendered", to_json(r.rendered)}, {"returned", to_json(r.returned)}}},
          {"notes", r.notes},
          {"losses", r.losses},
          {"missing", r.missing}};
}

ordered_json to_plot(const Replayed& r) {
  ordered_json out = to_json(r);
  out["curves"] = {{"rendered", to_json(r.rendered_curves)},
                   {"returned", to_json(r.returned_curves)}};
  return out;
}

}  // namespace voxtouch::replay
