#include "nodes/cli/accuracy/accuracy_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/accuracy/tool_row.hpp"
#include "nodes/cli/accuracy/accuracy_choice.hpp"

namespace voxtouch::cli {
namespace {

bool on_front(const AccuracyReport& r, std::size_t row) {
  return std::find(r.advice.front.begin(), r.advice.front.end(), row) != r.advice.front.end();
}

std::string_view model_word(const accuracy::AccuracySetting& setting) {
  return setting.virtual_tool ? "virtual_tool" : contact::name_of(setting.model);
}

/// The reference of a virtual tool.
std::string_view truth_word(accuracy::ToolTruth truth) {
  return truth == accuracy::ToolTruth::kBall ? "the exact ball"
                                             : "a god-object on the meshes' triangles";
}

/// Why a row has no figures; otherwise empty.
std::string no_figures(const accuracy::AccuracyRow& row) {
  if (!row.refused.empty())
    return row.refused;
  return row.contacts == 0 ? "no pose is in contact" : "";
}

/// Three digits in a column, never an exponent that would break it.
std::string cell(double value) {
  if (!std::isfinite(value))
    return "-";
  const double size = std::abs(value);
  if (size >= 99.95)
    return fmt::format("{:.0f}", value);
  if (size >= 9.995)
    return fmt::format("{:.1f}", value);
  if (size >= 0.9995)
    return fmt::format("{:.2f}", value);
  if (size < 0.0005)
    return "0.000";
  return fmt::format("{:.3f}", value);
}

constexpr const char* kHead =
    "     weights  e [mm]  shell    points  poses  missed      direction [deg]      force   noise  "
    "torque    onset [mm]           time [us]          memory   build\n"
    "                       [mm]                      [%]    mean  median     p95   /true     [%]  "
    "  [mm]  median   worst   median     p95   worst     [MB]     [s]\n";

std::string table_row(const AccuracyReport& report, std::size_t index) {
  const accuracy::AccuracyRow& r = report.rows[index];
  std::string text =
      fmt::format("  {}{} {:<7} {:>7.4g} {:>6.4g}", on_front(report, index) ? '*' : ' ',
                  report.advice.row == index ? '>' : ' ', weights_word(r.setting.weights),
                  r.setting.voxel_m * 1e3, r.setting.shell_voxel_m * 1e3);
  if (const std::string why = no_figures(r); !why.empty())
    return text + fmt::format("  {}{}\n", r.refused.empty() ? "" : "refused: ", why);
  return text + fmt::format(
                    " {:>9} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} "
                    "{:>7} {:>7} {:>8} {:>7}\n",
                    r.shell_points, r.contacts + r.missed, cell(100.0 * r.missed_ratio()),
                    cell(r.direction_mean_deg), cell(r.direction_median_deg),
                    cell(r.direction_p95_deg), cell(r.force_ratio), cell(r.magnitude_noise * 100.0),
                    cell(r.torque_error_m * 1e3), cell(r.onset_error_m * 1e3),
                    cell(r.onset_worst_m * 1e3), cell(r.median_us), cell(r.p95_us),
                    cell(r.worst_us), cell(static_cast<double>(r.bytes) / 1e6), cell(r.build_s));
}

/// The truth of the first virtual tool that was measured; all have the same.
std::string compared_with(const AccuracyReport& report) {
  for (const accuracy::AccuracyRow& r : report.rows)
    if (r.tool_truth != accuracy::ToolTruth::kNone)
      return fmt::format(", compared with {}", truth_word(r.tool_truth));
  return {};
}

std::string table(const AccuracyReport& report) {
  std::string text = kHead;
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const contact::ContactModelKind model = report.rows[i].setting.model;
    const bool tool = report.rows[i].setting.virtual_tool;
    if (i == 0 || report.rows[i - 1].setting.model != model ||
        report.rows[i - 1].setting.virtual_tool != tool)
      text += tool ? fmt::format("  virtual tool, hand 5 e deep{}\n", compared_with(report))
                   : fmt::format("  {}\n", contact::name_of(model));
    text += table_row(report, i);
  }
  return text;
}

std::string cells(const accuracy::Interval& both, double unit) {
  if (!std::isfinite(both.low) || !std::isfinite(both.high))
    return "-";
  return cell(both.low * unit) + " to " + cell(both.high * unit);
}

/// Depths of the rows; empty without any.
std::vector<double> depths_of(const AccuracyReport& report) {
  std::vector<double> out;
  for (const accuracy::AccuracyRow& r : report.rows) {
    if (r.depths.empty())
      continue;
    for (const accuracy::DepthFigures& d : r.depths)
      out.push_back(d.edges);
    break;
  }
  return out;
}

std::string depth_table(const AccuracyReport& report) {
  const std::vector<double> depths = depths_of(report);
  if (depths.empty())
    return {};
  const std::size_t width = 8 * depths.size();
  std::string text =
      fmt::format("  {:<40}{:>{}}  {:>{}}\n    {:<38}", "Over depth (a hand presses slowly)",
                  "direction, mean [deg]", width, "force /true", width, "depth [e]");
  for (const char* gap : {"", "  "}) {
    text += gap;
    for (const double edges : depths)
      text += fmt::format(" {:>7.4g}", edges);
  }
  text += '\n';
  for (const accuracy::AccuracyRow& r : report.rows) {
    if (r.depths.empty() || !no_figures(r).empty())
      continue;
    text += fmt::format("    {:<38}", describe(r.setting));
    for (const accuracy::DepthFigures& d : r.depths)
      text += fmt::format(" {:>7}", cell(d.direction_mean_deg));
    text += "  ";
    for (const accuracy::DepthFigures& d : r.depths)
      text += fmt::format(" {:>7}", cell(d.force_ratio));
    text += '\n';
  }
  return text + '\n';
}

std::string phase_table(const AccuracyReport& report) {
  std::string text = fmt::format(
      "  Over random grid offsets: minimum to maximum, and 95 % intervals of medians\n"
      "    {:<38} {:>15} {:>15} {:>15}  {:>15} {:>15} {:>16} {:>15}\n",
      "", "missed [%]", "dir., mean", "force /true", "dir., median", "torque [mm]", "onset [mm]",
      "time [us]");
  for (const accuracy::AccuracyRow& r : report.rows) {
    if (!no_figures(r).empty())
      continue;
    text += fmt::format("    {:<38} {:>15} {:>15} {:>15}  {:>15} {:>15} {:>16} {:>15}\n",
                        describe(r.setting), cells(r.phases.missed_ratio, 100.0),
                        cells(r.phases.direction_mean_deg, 1.0), cells(r.phases.force_ratio, 1.0),
                        cells(r.direction_median_95, 1.0), cells(r.torque_error_95, 1e3),
                        cells(r.onset_error_95, 1e3), cells(r.median_us_95, 1.0));
  }
  return text;
}

/// What was timed for a virtual tool; otherwise empty.
std::string slides_text(const AccuracyReport& report) {
  std::string queries;
  std::uint32_t without_truth = 0;
  for (const accuracy::AccuracyRow& r : report.rows)
    without_truth += r.without_truth;
  for (const accuracy::AccuracyRow& r : report.rows)
    if (r.setting.virtual_tool && no_figures(r).empty())
      queries += fmt::format("{}{}", queries.empty() ? "" : ", ", cell(r.queries_per_frame));
  if (queries.empty())
    return queries;
  std::string text = fmt::format(
      "  Virtual tool: the hand slides {:g} e a frame sideways, 5 e deep; {} queries a frame on "
      "average.\n"
      "  Pushing straight in needs no query.\n",
      accuracy::kSlideEdges, queries);
  if (without_truth > 0)
    text += fmt::format(
        "  Virtual tool: {} places not evaluated; the reference found no equilibrium there.\n",
        without_truth);
  return text;
}

std::string chosen_text(const AccuracyReport& r) {
  const accuracy::AccuracyAdvice& advice = r.advice;
  if (advice.refused_tool)
    return fmt::format("none; the scene's virtual tool was refused: {}",
                       r.rows[*advice.refused_tool].refused);
  if (advice.front.empty())
    return fmt::format("none; all {} settings were refused or have no contact", r.rows.size());
  if (!advice.row)
    return advice.met.has_value() ? "none; no setting has the limited figure"
                                  : "none; the Pareto front has no knee";
  const accuracy::AccuracyRow& row = r.rows[*advice.row];
  const char* why = advice.knee == advice.row ? ", the knee of the Pareto front"
                                              : ", the fastest and the most accurate";
  if (advice.met)
    why = *advice.met ? ", which meets the limit"
                      : ", the closest to the limit (no setting meets it)";
  return fmt::format("{}, {} us a frame, direction error {} deg{}", describe(row.setting),
                     cell(row.median_us), cell(row.direction_mean_deg), why);
}

std::string load_text(const AccuracyReport& r) {
  if (r.load_before < 0.0 || r.load_after < 0.0)
    return "load unknown";
  return fmt::format("load {:.1f} before and {:.1f} after", r.load_before, r.load_after);
}

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

template <class T>
nlohmann::ordered_json given(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

/// A figure of a row: its key in the JSON and the CSV. Not finite if the row has none.
struct Entry {
  const char* key;
  double value;
};

std::vector<Entry> figures(const accuracy::AccuracyRow& r) {
  std::vector<Entry> out{{"missed_ratio", r.missed_ratio()},
                         {"direction_mean_deg", r.direction_mean_deg},
                         {"direction_median_deg", r.direction_median_deg},
                         {"direction_p95_deg", r.direction_p95_deg},
                         {"force_ratio", r.force_ratio},
                         {"magnitude_noise", r.magnitude_noise},
                         {"torque_error_m", r.torque_error_m},
                         {"onset_error_m", r.onset_error_m},
                         {"onset_worst_m", r.onset_worst_m},
                         {"median_us", r.median_us},
                         {"p95_us", r.p95_us},
                         {"worst_us", r.worst_us},
                         {"queries_per_frame", r.queries_per_frame},
                         {"build_s", r.build_s}};
  if (!no_figures(r).empty())
    for (Entry& f : out)
      f.value = std::numeric_limits<double>::quiet_NaN();
  return out;
}

nlohmann::ordered_json both_ends(const accuracy::Interval& both) {
  return {number_or_null(both.low), number_or_null(both.high)};
}

/// Least and largest, or the ends of an interval: of each the CSV has two columns.
struct EntryPair {
  const char* key;
  accuracy::Interval value;
};

std::vector<EntryPair> phase_figures(const accuracy::AccuracyRow& r) {
  return {{"missed_ratio", r.phases.missed_ratio},
          {"direction_mean_deg", r.phases.direction_mean_deg},
          {"force_ratio", r.phases.force_ratio}};
}

std::vector<EntryPair> median_intervals(const accuracy::AccuracyRow& r) {
  return {{"direction_median_deg", r.direction_median_95},
          {"torque_error_m", r.torque_error_95},
          {"onset_error_m", r.onset_error_95},
          {"median_us", r.median_us_95}};
}

nlohmann::ordered_json spread_json(const accuracy::AccuracyRow& r) {
  nlohmann::ordered_json j;
  j["median_interval_95"] = nlohmann::ordered_json::object();
  for (const EntryPair& f : median_intervals(r))
    j["median_interval_95"][f.key] = both_ends(f.value);
  j["depths"] = nlohmann::ordered_json::array();
  for (const accuracy::DepthFigures& d : r.depths)
    j["depths"].push_back({{"edges", d.edges},
                           {"contacts", d.contacts},
                           {"missed", d.missed},
                           {"direction_mean_deg", number_or_null(d.direction_mean_deg)},
                           {"force_ratio", number_or_null(d.force_ratio)},
                           {"magnitude_noise", number_or_null(d.magnitude_noise)}});
  j["phases"] = {{"phases", r.phases.phases}, {"contacts", r.phases.contacts}};
  for (const EntryPair& f : phase_figures(r))
    j["phases"][f.key] = both_ends(f.value);
  return j;
}

nlohmann::ordered_json row_json(const AccuracyReport& report, std::size_t index) {
  const accuracy::AccuracyRow& r = report.rows[index];
  const bool built = r.refused.empty();
  nlohmann::ordered_json j{
      {"model", model_word(r.setting)},
      {"weights", weights_word(r.setting.weights)},
      {"voxel_m", r.setting.voxel_m},
      {"shell_voxel_m", r.setting.shell_voxel_m},
      {"shell_points", built ? nlohmann::ordered_json(r.shell_points) : nlohmann::ordered_json()},
      {"bytes", built ? nlohmann::ordered_json(r.bytes) : nlohmann::ordered_json()},
      {"contacts", r.contacts},
      {"missed", r.missed}};
  if (r.tool_truth != accuracy::ToolTruth::kNone) {
    j["truth"] = truth_word(r.tool_truth);
    j["without_truth"] = r.without_truth;
  }
  for (const Entry& f : figures(r))
    j[f.key] = number_or_null(f.value);
  j.update(spread_json(r));
  j["pareto"] = on_front(report, index);
  j["recommended"] = report.advice.row == index;
  j["refused"] = built ? nlohmann::ordered_json() : nlohmann::ordered_json(r.refused);
  return j;
}

std::string csv_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text)
    out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string to_text(const AccuracyReport& r) {
  std::string text = fmt::format(
      "\n"
      "  Chosen: {}\n"
      "\n"
      "  Accuracy and time: scene {}, {} contacts, each {} e deep, seed {}\n"
      "\n"
      "{}\n"
      "{}{}\n",
      chosen_text(r), r.scene, r.contacts, r.depth_edges, r.seed, table(r), depth_table(r),
      phase_table(r));
  text +=
      "  *  on the Pareto front: no other setting is both faster and better in direction (missed "
      "contacts count as 180 deg)";
  if (r.advice.row)
    text += ";  > chosen";
  text += fmt::format(
      "\n"
      "  Times: CPU time of one frame, median, 95th percentile and worst, on {} ({} CPUs, {}; {}, "
      "{}).\n"
      "{}  Other load changes the times: compare ratios only.\n",
      r.machine.processor, r.machine.cpus, load_text(r), r.machine.compiler, r.machine.flags,
      slides_text(r));
  return text;
}

nlohmann::ordered_json to_json(const AccuracyReport& r) {
  nlohmann::ordered_json j;
  j["ok"] = !r.advice.front.empty() && r.advice.met.value_or(true);
  j["scene"] = r.scene;
  j["scene_hash"] = r.scene_hash;
  j["scene_voxel_m"] = r.scene_voxel_m;
  j["options"] = {{"seed", r.seed}, {"contacts", r.contacts}, {"depth_edges", r.depth_edges}};
  j["request"] = {{"direction_deg", given(r.goal.direction_deg)},
                  {"noise", given(r.goal.noise)},
                  {"torque_m", given(r.goal.torque_m)},
                  {"onset_m", given(r.goal.onset_m)},
                  {"within_us", given(r.goal.within_us)}};
  const auto load = [](double value) {
    return value < 0.0 ? nlohmann::ordered_json() : nlohmann::ordered_json(value);
  };
  j["conditions"] = {
      {"time", "CPU time of one frame on this thread; only ratios are comparable between machines"},
      {"version", r.machine.version},
      {"processor", r.machine.processor},
      {"cpus", r.machine.cpus},
      {"load_before", load(r.load_before)},
      {"load_after", load(r.load_after)},
      {"compiler", r.machine.compiler},
      {"flags", r.machine.flags}};
  j["rows"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < r.rows.size(); ++i)
    j["rows"].push_back(row_json(r, i));
  j["advice"] = {{"sentence", chosen_text(r)},
                 {"row", given(r.advice.row)},
                 {"met", given(r.advice.met)},
                 {"front", r.advice.front},
                 {"knee", given(r.advice.knee)}};
  return j;
}

std::string to_csv(const AccuracyReport& report) {
  std::string text = "model,weights,voxel_m,shell_voxel_m,shell_points,bytes,contacts,missed";
  const std::vector<double> depths = depths_of(report);
  for (const Entry& f : figures({}))
    text += fmt::format(",{}", f.key);
  for (const EntryPair& f : median_intervals({}))
    text += fmt::format(",{0}_95_low,{0}_95_high", f.key);
  for (const double edges : depths)
    text += fmt::format(
        ",missed_at_{0}_e,direction_mean_deg_at_{0}_e,force_ratio_at_{0}_e,magnitude_noise_at_{0}_"
        "e",
        edges);
  text += ",phases";
  for (const EntryPair& f : phase_figures({}))
    text += fmt::format(",{0}_phases_low,{0}_phases_high", f.key);
  text += ",pareto,recommended,refused\n";
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const accuracy::AccuracyRow& r = report.rows[i];
    const auto add = [&text](double value) {
      text += std::isfinite(value) ? fmt::format(",{}", value) : std::string(",");
    };
    text += fmt::format("{},{},{},{}", model_word(r.setting), weights_word(r.setting.weights),
                        r.setting.voxel_m, r.setting.shell_voxel_m);
    text += r.refused.empty()
                ? fmt::format(",{},{},{},{}", r.shell_points, r.bytes, r.contacts, r.missed)
                : std::string(",,,0,0");
    for (const Entry& f : figures(r))
      add(f.value);
    for (const EntryPair& f : median_intervals(r))
      add(f.value.low), add(f.value.high);
    for (std::size_t d = 0; d < depths.size(); ++d) {
      if (d < r.depths.size())
        add(r.depths[d].missed), add(r.depths[d].direction_mean_deg), add(r.depths[d].force_ratio),
            add(r.depths[d].magnitude_noise);
      else
        text += ",,,,";
    }
    text += fmt::format(",{}", r.phases.phases);
    for (const EntryPair& f : phase_figures(r))
      add(f.value.low), add(f.value.high);
    text += fmt::format(",{:d},{:d},{}\n", on_front(report, i), report.advice.row == i,
                        r.refused.empty() ? std::string() : csv_quoted(r.refused));
  }
  return text;
}

}  // namespace voxtouch::cli
