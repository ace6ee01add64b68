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
#include "nodes/log/progress.hpp"
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

constexpr const char* kAccuracyDescription =
    "What accuracy costs in time: every contact model at every voxel size and shell density asked "
    "for, measured on "
    "the\n"
    "same random contacts of the scene against the reference (closed forms or the exact mesh), "
    "with the time of a "
    "frame.\n"
    "A table, one sentence of advice, and on demand JSON, CSV and a picture.";

constexpr const char* kFooter =
    "How it is measured: the tool is brought into contact with the wall in --contacts random "
    "places and attitudes, "
    "each\n"
    "--depth-edges voxel edges deep, and the force of each setting is held beside the reference's. "
    "A virtual tool is pressed\n"
    "with the hand 5 edges deep, and held beside the exact ball that is drawn to the same hand; it "
    "has no onset.\n"
    "\n"
    "What the figures mean\n"
    "  missed     contacts that the reference feels and the setting does not. They count in all "
    "that follows\n"
    "  direction  angle between the force and the true one [deg], a missed contact being 180 off: "
    "mean, which settings are\n"
    "             ranked by, median and 95th percentile. A person feels it as a wall that is "
    "tilted or that grates when slid over\n"
    "  force      mean size of the force over the true one's: 1 without bias, 0 for a missed "
    "contact\n"
    "  noise      scatter (standard deviation over mean) of the same: a wall that ripples\n"
    "  torque     error of the torque over the force: by how much the force seems to act beside "
    "its true line [mm]\n"
    "  onset      gap at which the force begins: > 0 before the wall is touched, < 0 inside it "
    "[mm]\n"
    "  time       CPU time of one frame [us]; a 1 kHz loop has 1000 for everything. Of a virtual "
    "tool: over the frames of a hand that\n"
    "             slides 1/40 e sideways each (50 mm/s at e = 2 mm and 1 kHz), with the queries "
    "that these make\n"
    "  memory     voxmap, pointshell, distance field; build: CPU time from the meshes to the first "
    "frame [s]\n"
    "\n"
    "Spread: 60 of the contacts once more, pressed in slowly to 1/4 to 4 e, and with the grid "
    "moved by four random shares of a voxel.\n"
    "Intervals of medians are those between sorted values that the binomial distribution gives 95 "
    "%.\n"
    "\n"
    "Where to look: rows marked * are on the Pareto front, all others are beaten by one of them in "
    "time and in "
    "direction.\n"
    "Settings that point within 0.001 deg count as equal. Times are of this machine and of what "
    "else runs on it: "
    "compare\n"
    "their ratios. Halving e makes about four times the points.\n"
    "\n"
    "Exit status 0; 1 where the wish is not met by any setting or nothing could be measured.\n"
    "\n"
    "Examples\n"
    "  voxtouch accuracy deploy/scenes/cup.yaml --plot accuracy.png             what there is to "
    "choose from\n"
    "  voxtouch accuracy deploy/scenes/cup.yaml --want-direction-deg 1          the cheapest that "
    "points within 1 deg\n"
    "  voxtouch accuracy deploy/scenes/cup.yaml --within-us 200                 the most accurate "
    "within 200 us\n"
    "  voxtouch accuracy deploy/scenes/cup.yaml --models field --budgets 1,0.5,0.25   what leaving "
    "out points costs, and saves\n"
    "  voxtouch accuracy deploy/scenes/plane.yaml --models adapted,field --voxel-sizes 0.004,0.002 "
    "--shell-densities "
    "1,2";

/// Tells at once, then each second: what is being done, and how long the rest takes where the
/// processor is shared as so far.
std::function<void(const std::string&, double, double)> tell_time_left() {
  const auto line = [](const std::string& what, double share, double left_s) {
    return fmt::format("{:.0f} %, about {:.0f} s left: {}", 100.0 * share, left_s, what);
  };
  return [line, tell = log::tell_each_second("accuracy"), begun = std::chrono::steady_clock::now(),
          cpu_before = thread_cpu_s(),
          first = true](const std::string& what, double share, double left_s) mutable {
    if (std::exchange(first, false))
      log::tell("accuracy: {}\n", line(what, share, left_s));
    constexpr double kToldByS = 1.0;
    const double gone_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun)
                              .count(),
                 used_s = thread_cpu_s() - cpu_before;
    tell(line(what, share, left_s * (used_s > kToldByS ? std::max(1.0, gone_s / used_s) : 1.0)));
  };
}

AccuracyReport measure(const AccuracyVerb& o) {
  o.goal.validate();
  const scene::Scene scene = scene::load_scene(o.scene);
  for (const std::string& warning : scene.warnings)
    log::tell("warning: {}\n", warning);
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
  mesh_import::rehearse_reading(scene);
  options.progress = tell_time_left();
  log::tell("{} settings on {} contacts each\n", settings.size(), o.contacts);
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
  log::print_result("{}", o.json ? json + "\n" : to_text(report));
  if (csv) {
    csv->keep(to_csv(report));
    log::tell("{} holds the table\n", o.csv.string());
  }
  if (!o.plot.empty())
    log::tell("{}\n", draw_picture("accuracy", json, o.plot));
  if (!o.page.empty())
    log::tell("{}\n", draw_picture("costs", json, o.page));
  return !report.advice.front.empty() && report.advice.met.value_or(true) ? 0 : 1;
}

/// One word after the option, split at its commas: what follows may be the scene.
template <class T>
CLI::Option* add_list(CLI::App& verb, const char* name, std::vector<T>& list, const char* help) {
  return verb.add_option(name, list, help)->delimiter(',')->allow_extra_args(false);
}

void add_goals(CLI::App& verb, accuracy::AccuracyGoal& goal) {
  constexpr const char* kGroup = "What you want (errors, all of which must be kept, or a time)";
  const auto add = [&](const char* name, std::optional<double>& value, const char* help) {
    verb.add_option(name, value, help)->group(kGroup);
  };
  add("--want-direction-deg", goal.direction_deg,
      "Names the cheapest setting whose mean direction error is at most this; a missed contact is "
      "180 deg off");
  add("--want-noise", goal.noise, "... whose magnitude noise is at most this, 0.01 for 1 %");
  add("--want-torque-m", goal.torque_m,
      "... whose median torque error, as a lever arm, is at most this [m]");
  add("--want-onset-m", goal.onset_m,
      "... whose median onset is at most this far from the wall, either way [m]");
  add("--within-us", goal.within_us,
      "Names the setting with the least direction error whose median frame stays within this");
}

}  // namespace

void add_accuracy(CLI::App& app, Action& action) {
  auto o = std::make_shared<AccuracyVerb>();
  CLI::App* verb = app.add_subcommand("accuracy", kAccuracyDescription);
  verb->footer(kFooter);
  verb->add_option("SCENE", o->scene,
                   "Scene file (YAML), or the name of one that comes with voxtouch")
      ->required()
      ->transform(runtime::scene_argument());
  add_list(*verb, "--models", o->choice.models, "original,adapted,field,virtual_tool; default: all")
      ->check(CLI::IsMember({"original", "adapted", "field", "virtual_tool"}));
  add_list(*verb, "--weights", o->choice.weights,
           "one,area: what a shell point counts; default: both. field knows area only")
      ->check(CLI::IsMember({"one", "area"}));
  add_list(*verb, "--voxel-sizes", o->choice.voxel_sizes_m,
           "Voxel edges e of the static map [m]; default: the scene's own times 2, 1 and 1/2")
      ->check(runtime::require_positive);
  add_list(*verb, "--shell-densities", o->choice.shell_densities,
           "The shell is made with voxels of e / density, so 2 makes about four times the points; "
           "default: 1")
      ->check(runtime::require_positive);
  add_list(*verb, "--budgets", o->choice.budgets,
           "Shares of the shell's points that a frame may test, as under a scene's budget_us; "
           "default: 1, all of them. A virtual tool leaves out none")
      ->check(runtime::require_positive)
      ->check(CLI::Range(1e-6, 1.0));
  verb->add_option("--contacts", o->contacts, "Contact poses, the same for every setting")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  verb->add_option("--depth-edges", o->depth_edges, "How deep each contact is, in e of the setting")
      ->capture_default_str()
      ->check(runtime::require_positive)  // a range lets NaN through
      ->check(CLI::Range(1e-3, 20.0));
  verb->add_option("--seed", o->seed, "Chooses the contact poses")
      ->capture_default_str()
      ->check(runtime::require_whole);
  add_goals(*verb, o->goal);
  verb->add_flag("--json", o->json, "One JSON object on stdout; all else goes to stderr");
  verb->add_option("--csv", o->csv, "Writes the table as CSV");
  verb->add_option(
      "--plot", o->plot,
      "Draws direction error and noise over time, with the Pareto front, as .png, .svg or .pdf");
  verb->add_option("--page", o->page,
                   "Draws one page at the scene's own voxels: force, direction error and noise "
                   "over depth, time of a frame");
  verb->callback([o, &action] { action = [o] { return run(*o); }; });
}

}  // namespace voxtouch::cli
