#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "nodes/cli/design/design_input.hpp"
#include "nodes/cli/design/design_report.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/output_file.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

struct DesignVerbOptions : DesignInput {
  std::string device = "sim-phantom";
  std::filesystem::path plot, csv;
  bool json = false;
};

int design(const DesignVerbOptions& o) {
  std::unique_ptr<OutputFile> csv;
  if (!o.plot.empty())
    check_picture(o.plot);
  if (!o.csv.empty())
    csv = std::make_unique<OutputFile>(o.csv);
  const coupling::design::DeviceModel device = find_device(o.device);
  if (!o.scene.empty())
    console::log("building {} to count its contact points\n", o.scene.stem().string());
  const DesignReport report = work_out(o, device, [&](const scene::Scene& scene) {
    return scene_build::build_here(scene, {.who = "design"});
  });
  const std::string json = to_json(report).dump(2);
  console::print_result("{}", o.json ? json + "\n" : to_text(report));
  if (csv) {
    csv->keep(to_csv(report));
    console::log("stable region: {}\n", o.csv.string());
  }
  if (!o.plot.empty())
    console::log("{}\n", draw_picture("design", json, o.plot));
  return report.design.status == coupling::design::DesignStatus::kInfeasible ? 1 : 0;
}

}  // namespace

void add_design(CLI::App& app, Action& action) {
  auto o = std::make_shared<DesignVerbOptions>();
  CLI::App* verb = app.add_subcommand("design");
  verb->add_option("--device", o->device, "Device name or device file (deploy/devices/*.yaml)")
      ->capture_default_str();
  verb->add_option("--scene", o->scene,
                   "Scene to design for; default: a contact of the device's largest stiffness")
      ->transform(runtime::scene_argument());
  verb->add_option("--hand", o->hand,
                   "pen, arm or any_passive; default: the scene's, else the device's grip")
      ->check(CLI::IsMember({"pen", "arm", "any_passive"}));
  verb->add_flag("--gripped", o->gripped, "The device is always gripped: skips the released cases");
  verb->add_option("--kind", o->kind, "auto, shaping_filter, spring_damper or direct")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "shaping_filter", "spring_damper", "direct"}));
  verb->add_option("--cutoff-hz", o->cutoff_hz,
                   "Requested cut-off of the shaping filter, w0 / (2 pi) [Hz]")
      ->capture_default_str()
      ->check(runtime::require_positive);
  verb->add_option("--gain-margin", o->gain_margin,
                   "Required gain margin: stiffness at the stability limit over displayed "
                   "stiffness, worst case")
      ->capture_default_str()
      ->check(runtime::require_positive)  // which refuses nan
      ->check(CLI::Range(1.0, 100.0));
  verb->add_option(
          "--min-damping-ratio", o->min_damping_ratio,
          "Minimum damping ratio of the dominant mode in contact when gripped; a third of it when "
          "released.\n"
          "Stiffness is reduced to reach it; 0: no minimum. Default: the scene's, else 0.3")
      ->check(CLI::Range(0.0, 0.99));
  verb->add_option("--damping-force-ratio", o->damping_force_ratio,
                   "Limit of the damping force, as a ratio of contact and effect force; 0: no "
                   "limit. Default: the scene's;\n"
                   "else 0.35 if it keeps 2/3 of the stiffness, else the smallest of 0.7, 2, 6, 24 "
                   "that keeps 9/10")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--stiffness", o->stiffness_n_per_m,
                   "Contact stiffness at the hand, without a scene [N/m]")
      ->check(runtime::require_positive);
  verb->add_flag("--no-damping", o->no_damping, "No injected damping");
  verb->add_flag("--no-velocity-windows", o->no_velocity_windows,
                 "Injected damping uses the velocity of a first-order filter only");
  verb->add_option("--csv", o->csv,
                   "Writes critical and certified stiffness over the cut-off as CSV");
  verb->add_option("--plot", o->plot,
                   "Plots the stable region with the chosen point (.png, .svg or .pdf)");
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->callback([o, &action] { action = [o] { return design(*o); }; });
}

}  // namespace voxtouch::cli
