#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/rendering/build.hpp"
#include "core/fitting/design_problem.hpp"
#include "core/fitting/fit_coupling.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/cli/design/design_report.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/output_file.hpp"
#include "nodes/cli/plot_tool.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/log/progress.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "nodes/runtime/options.hpp"
#include "nodes/runtime/parallel_for.hpp"
#include "nodes/runtime/scene_argument.hpp"

namespace voxtouch::cli {
namespace {

struct DesignVerbOptions {
  std::string device = "sim-phantom", hand, kind = "auto";
  std::filesystem::path scene, plot, csv;
  double cutoff_hz = 5.0, gain_margin = 2.0, stiffness_n_per_m = 0.0, cap_n_per_m = 0.0;
  bool held = false, no_damping = false, json = false;
};

std::string hand_text(const coupling::design::OperatorRange& hand, const std::string& name) {
  const coupling::design::HandRange& h = hand.translation;
  if (h.any_passive) return "any hand that creates no energy";
  return fmt::format("{}: {:.3g} to {:.3g} kg, {:.3g} to {:.3g} Ns/m, {:.4g} to {:.4g} N/m{}", name, h.mass_min,
                     h.mass_max, h.damping_min, h.damping_max, h.stiffness_min, h.stiffness_max,
                     h.may_release ? ", or nobody" : ", always held");
}

/// The request without a scene: whatever the device can show, or the stiffness given, in one contact that may be capped.
coupling::design::DesignProblem request_for_device(const DesignVerbOptions& o, const coupling::design::DeviceModel& device) {
  scene::Scene scene;
  scene.voxel_size_m = 0.0;
  scene.design.emplace();
  const double most = o.stiffness_n_per_m > 0 ? o.stiffness_n_per_m : device.translation.max_stiffness;
  const double most_rotation = device.gives_torque ? device.rotation.max_stiffness : 0.0;
  return fitting::design_problem(scene, device, {0.01 * most, most}, {0.01 * most_rotation, most_rotation});
}

/// What the command line says goes over what the scene says.
void apply(const DesignVerbOptions& o, const coupling::design::DeviceModel& device, coupling::design::DesignProblem& request,
           std::string& hand) {
  if (!o.hand.empty()) {
    scene::DesignOptions options;
    coupling::design::Grip grip = device.grip;
    if (o.hand == "any_passive")
      options.hand = scene::HandOption::kAnyPassive;
    else
      coupling::design::parse_grip(o.hand, grip);
    request.hand = scene::operator_range(options, grip);
    hand = o.hand;
  }
  if (o.held) request.hand.translation.may_release = request.hand.rotation.may_release = false;
  if (o.no_damping) request.goals.allow_injected_damping = false;
}

/// The problem that the command line and its scene pose, and the words for it: without what is found.
DesignReport problem_of(const DesignVerbOptions& o, const coupling::design::DeviceModel& device) {
  DesignReport out;
  out.device = device.name;
  std::string hand = std::string(coupling::design::name_of(device.grip));
  if (o.scene.empty()) {
    out.request = request_for_device(o, device);
    out.contact =
        fmt::format("up to {:.4g} N/m, which the coupling may cap (no scene is given)", out.request.contact.all_points);
  } else {
    const scene::Scene scene = scene::load_scene(o.scene);
    log::tell("building {} to count its points\n", scene.name);
    const auto built =
        rendering::build_scene(scene, runtime::threaded_for(), {.read = mesh_import::mesh_process()}, log::tell_each_second("design"));
    const rendering::Plan& plan = built->plan();
    out.request = fitting::design_problem(scene, device, plan.contact_n_per_m, plan.contact_nm_per_rad);
    if (scene.design) hand = std::string(scene::name_of(scene.design->hand));
    const bool spring = rendering::is_spring({plan.contact_n_per_m, plan.contact_nm_per_rad});
    out.contact = spring ? fmt::format("scene {}: the spring of a virtual tool, up to the {:.4g} N/m that the device can show, at the hand",
                                       scene.name, out.request.contact.all_points)
                         : fmt::format("scene {}: {:.4g} N/m of one point, up to {:.4g} N/m of all {} points, at the hand", scene.name,
                    out.request.contact.one_point, out.request.contact.all_points, plan.shell_points);
    if (const effects::EffectSpec* external = effects::external_of(scene.effects)) out.contact += ". " + effects::no_certificate_sentence(external->name);
  }
  if (o.scene.empty() || o.kind != "auto") out.request.goals.kind = o.kind;
  if (o.scene.empty() || o.cutoff_hz != 5.0) out.request.goals.cutoff_hz = o.cutoff_hz;
  if (o.scene.empty() || o.gain_margin != 2.0) out.request.goals.gain_margin = o.gain_margin;
  apply(o, device, out.request, hand);
  out.hand = hand_text(out.request.hand, hand);
  return out;
}

int design(const DesignVerbOptions& o) {
  std::unique_ptr<OutputFile> csv;
  if (!o.plot.empty()) check_picture(o.plot);
  if (!o.csv.empty()) csv = std::make_unique<OutputFile>(o.csv);
  const coupling::design::DeviceModel device = find_device(o.device);
  DesignReport report = problem_of(o, device);
  report.design = coupling::design::design_coupling(report.request);
  report.paper = judge_paper_recipe(report.request);
  report.region = region_round(report.request, report.design);
  report.law = region_of_law(report.request, report.design);
  const std::string json = to_json(report).dump(2);
  log::print_result("{}", o.json ? json + "\n" : to_text(report));
  if (csv) {
    csv->keep(to_csv(report));
    log::tell("{} holds the stable region\n", o.csv.string());
  }
  if (!o.plot.empty()) log::tell("{}\n", draw_picture("design", json, o.plot));
  return report.design.status == coupling::design::DesignStatus::kInfeasible ? 1 : 0;
}

}  // namespace

void add_design(CLI::App& app, Action& action) {
  auto o = std::make_shared<DesignVerbOptions>();
  CLI::App* verb =
      app.add_subcommand("design",
                         "The virtual coupling that fits a device, the hands that may hold it and the contact, with "
                         "its margins; or what it would\n"
                         "take. All figures are at the hand. Exit status 1 where nothing holds.\n"
                         "Try: voxtouch design --device sim-phantom --scene deploy/scenes/cup.yaml --plot region.png");
  verb->add_option("--device", o->device, "A device by name, or a file that describes one (deploy/devices/*.yaml)")
      ->capture_default_str();
  verb->add_option("--scene", o->scene,
                   "Scene whose contact and wishes are to be met; default: whatever the device can show")
      ->transform(runtime::scene_argument());
  verb->add_option("--hand", o->hand, "pen, arm or any_passive; default: the scene's, else how the device is held")
      ->check(CLI::IsMember({"pen", "arm", "any_passive"}));
  verb->add_flag("--held", o->held, "Somebody always holds the device: nobody letting go is not among the cases");
  verb->add_option("--kind", o->kind, "auto, shaping_filter, spring_damper or direct")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "shaping_filter", "spring_damper", "direct"}));
  verb->add_option("--cutoff-hz", o->cutoff_hz, "Wished cut-off of the shaping filter, w0 / (2 pi)")
      ->capture_default_str()
      ->check(runtime::require_positive);
  verb->add_option("--gain-margin", o->gain_margin, "How much stiffer the worst case may get before it is unstable")
      ->capture_default_str()
      ->check(runtime::require_positive)  // which refuses nan
      ->check(CLI::Range(1.0, 100.0));
  verb->add_option("--stiffness", o->stiffness_n_per_m, "Without a scene: the contact's stiffness at the hand [N/m]")
      ->check(runtime::require_positive);
  verb->add_flag("--no-damping", o->no_damping, "No injected damping");
  verb->add_option("--csv", o->csv, "Writes the stable region: critical and certified stiffness over the cut-off");
  verb->add_option("--plot", o->plot, "Draws the stable region with the chosen point, as .png, .svg or .pdf");
  verb->add_flag("--json", o->json, "One JSON object on stdout; all else goes to stderr");
  verb->callback([o, &action] { action = [o] { return design(*o); }; });
}

}  // namespace voxtouch::cli
