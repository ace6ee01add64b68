#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/advice.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/cli/accuracy/accuracy_choice.hpp"
#include "nodes/cli/accuracy/accuracy_report.hpp"
#include "nodes/cli/machine.hpp"
#include "nodes/cli/output_file.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/progress.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/scene_argument.hpp"

namespace voxtouch::cli {
namespace {

struct AccuracyVerb {
  std::filesystem::path scene, plot, page, csv;
  AccuracyChoice choice;
  accuracy::AccuracyGoal goal;
  std::uint64_t seed = 1;
  std::uint32_t contacts = 200;
  double depth_edges = 0.5;
  bool json = false;
};

/// Reports at once, then each second: the current step, and the remaining time at the present
/// processor load.
std::function<void(const std::string&, double, double)> report_time_left() {
  const auto line = [](const std::string& what, double fraction, double left_s) {
    return fmt::format("{:.0f} %, about {:.0f} s remain: {}", 100.0 * fraction, left_s, what);
  };
  return [line, log_line = console::log_each_second("accuracy"),
          begun = std::chrono::steady_clock::now(), cpu_before = thread_cpu_s(),
          first = true](const std::string& what, double fraction, double left_s) mutable {
    if (std::exchange(first, false))
      console::log("accuracy: {}\n", line(what, fraction, left_s));
    constexpr double kReportAfterS = 1.0;
    const double gone_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun)
                              .count(),
                 used_s = thread_cpu_s() - cpu_before;
    log_line(line(what, fraction,
                  left_s * (used_s > kReportAfterS ? std::max(1.0, gone_s / used_s) : 1.0)));
  };
}

AccuracyReport measure(const AccuracyVerb& o) {
  o.goal.validate();
  const scene::Scene scene = scene::load_scene(o.scene);
  for (const std::string& warning : scene.warnings)
    console::log("warning: {}\n", warning);
  const std::vector<accuracy::AccuracySetting> settings = settings_of(o.choice, scene.voxel_size_m);
  AccuracyReport report;
  report.scene = scene.name;
  report.scene_hash = scene.hash;
  report.scene_voxel_m = scene.voxel_size_m;
  report.seed = o.seed, report.contacts = o.contacts, report.depth_edges = o.depth_edges;
  report.goal = o.goal;
  report.machine = this_machine();
  report.load_before = load_average();

  accuracy::AccuracyOptions options;
  options.seed = o.seed, options.contacts = o.contacts, options.depth_edges = o.depth_edges;
  options.cpu_time_s = thread_cpu_s;
  options.read = mesh_import::mesh_process();
  mesh_import::dry_run_reading(scene);
  options.progress = report_time_left();
  console::log("{} settings, {} contacts each\n", settings.size(), o.contacts);
  report.rows = accuracy::measure_accuracy(
      scene, settings, options, serial_for());  // one thread: its CPU time is the frame's
  report.load_after = load_average();
  report.advice = accuracy::advise(report.rows, o.goal, scene.virtual_tool());
  return report;
}

int run(const AccuracyVerb& o) {
  std::unique_ptr<OutputFile> csv;
  for (const std::filesystem::path& picture : {o.plot, o.page})
    if (!picture.empty())
      check_picture(picture);
  if (!o.csv.empty())
    csv = std::make_unique<OutputFile>(o.csv);
  const AccuracyReport report = measure(o);
  const std::string json = to_json(report).dump(2);
  console::print_result("{}", o.json ? json + "\n" : to_text(report));
  if (csv) {
    csv->keep(to_csv(report));
    console::log("table: {}\n", o.csv.string());
  }
  if (!o.plot.empty())
    console::log("{}\n", draw_picture("accuracy", json, o.plot));
  if (!o.page.empty())
    console::log("{}\n", draw_picture("costs", json, o.page));
  return !report.advice.front.empty() && report.advice.met.value_or(true) ? 0 : 1;
}

/// One word after the option, split at its commas: the next word may be the scene.
template <class T>
CLI::Option* add_list(CLI::App& verb, const char* name, std::vector<T>& list, const char* help) {
  return verb.add_option(name, list, help)->delimiter(',')->allow_extra_args(false);
}

void add_goals(CLI::App& verb, accuracy::AccuracyGoal& goal) {
  constexpr const char* kGroup =
      "Requirements (limits of error, which all must be met, or a limit of time)";
  const auto add = [&](const char* name, std::optional<double>& value, const char* help) {
    verb.add_option(name, value, help)->group(kGroup);
  };
  add("--want-direction-deg", goal.direction_deg,
      "Chooses the fastest setting with at most this mean direction error [deg]; a missed contact "
      "counts as 180");
  add("--want-noise", goal.noise,
      "... with at most this noise of the force's magnitude (0.01: 1 %)");
  add("--want-torque-m", goal.torque_m,
      "... with at most this median torque error, as a lever arm [m]");
  add("--want-onset-m", goal.onset_m,
      "... with a median onset at most this far from the surface, inside or outside [m]");
  add("--within-us", goal.within_us,
      "Chooses the setting with the smallest direction error whose median frame takes at most this "
      "time");
}

}  // namespace

void add_accuracy(CLI::App& app, Action& action) {
  auto o = std::make_shared<AccuracyVerb>();
  CLI::App* verb = app.add_subcommand("accuracy");
  verb->add_option("SCENE", o->scene, "Scene file (YAML), or the name of a shipped scene")
      ->required()
      ->transform(runtime::scene_argument());
  add_list(*verb, "--models", o->choice.models, "original,adapted,field,virtual_tool; default: all")
      ->check(CLI::IsMember({"original", "adapted", "field", "virtual_tool"}));
  add_list(*verb, "--weights", o->choice.weights,
           "Weight of a shell point: one,area; default: both. Model field has area only")
      ->check(CLI::IsMember({"one", "area"}));
  add_list(*verb, "--voxel-sizes", o->choice.voxel_sizes_m,
           "Voxel edges e of the static map [m]; default: the scene's edge times 2, 1 and 1/2")
      ->check(runtime::require_positive);
  add_list(*verb, "--shell-densities", o->choice.shell_densities,
           "The pointshell is built with voxels of e / density: 2 gives about four times the "
           "points; default: 1")
      ->check(runtime::require_positive);
  verb->add_option("--contacts", o->contacts, "Contact poses, the same for every setting")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option("--depth-edges", o->depth_edges,
                   "Depth of each contact, in voxel edges e of the setting")
      ->capture_default_str()
      ->check(runtime::require_positive)  // a range does not refuse NaN
      ->check(CLI::Range(1e-3, 20.0));
  verb->add_option("--seed", o->seed, "Seed of the random contact poses")
      ->capture_default_str()
      ->check(runtime::require_whole);
  add_goals(*verb, o->goal);
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->add_option("--csv", o->csv, "Writes the table as CSV");
  verb->add_option(
      "--plot", o->plot,
      "Plots direction error and noise over time, with the Pareto front (.png, .svg or .pdf)");
  verb->add_option("--page", o->page,
                   "Plots force, direction error and noise over depth, and time of a frame, at the "
                   "scene's voxel edge");
  verb->callback([o, &action] { action = [o] { return run(*o); }; });
}

}  // namespace voxtouch::cli
