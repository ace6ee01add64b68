#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/device_fit/device_check.hpp"
#include "core/device_fit/fit_coupling.hpp"
#include "core/device_fit/force_preview.hpp"
#include "core/rendering/build.hpp"
#include "core/scene/scene_file.hpp"
#include "nodes/cli/force_line.hpp"
#include "nodes/cli/known_device.hpp"
#include "nodes/cli/machine.hpp"
#include "nodes/cli/plan/plan_report.hpp"
#include "nodes/cli/verbs.hpp"
#include "nodes/design_text/design_text.hpp"
#include "nodes/rendering/plan_ring.hpp"
#include "nodes/runtime/scene_argument.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

struct PlanVerb {
  std::filesystem::path scene;
  std::string device, model;
  int frames = 1000;
  bool json = false, no_measure = false;
};

/// Sets `fitted` to the coupling on this device, if it may run.
DeviceVerdict judge(const PlanVerb& o, const scene::Scene& scene,
                    const rendering::BuiltScene& built,
                    std::optional<coupling::CouplingSpec>& fitted) {
  const rendering::Plan& plan = built.plan();
  const coupling::design::DeviceModel device = find_device(o.device);
  DeviceVerdict out{.device = o.device, .errors = {}, .notes = {}};
  if (!device.gives_torque)
    out.notes.emplace_back(kRotationIsLatched);
  const device_fit::FittedCoupling fit =
      device_fit::fit_coupling(scene, device, plan.contact_n_per_m, plan.contact_nm_per_rad);
  if (!fit.refusal.empty()) {
    out.errors.push_back(design_text::sentence_of(fit.refusal));
    return out;
  }
  if (scene.design) {
    out.notes.push_back(fmt::format(
        "The designed coupling displays {:.4g} N/m at the hand, requested {:.4g} N/m.",
        fit.design.translation.displayed_stiffness, fit.design.translation.requested_stiffness));
  } else {
    const device_fit::DeviceCheck all =
        device_fit::check_device(scene, device, plan.contact_n_per_m.all_points);
    out.notes.insert(out.notes.end(), all.warnings.begin(), all.warnings.end());
    if (!all.fits())
      out.notes.push_back("With all points in contact: " + all.errors.front());
  }
  const rendering::StiffnessBounds bounds{plan.contact_n_per_m, plan.contact_nm_per_rad};
  if (const auto preview = device_fit::force_preview(fit, scene, device, bounds, plan.tool_reach_m))
    for (const std::string& line : force_lines(*preview, device.name))
      out.notes.push_back(line);
  fitted = scene.design ? fit.spec : scene.coupling;
  return out;
}

PlanReport make_report(const PlanVerb& o) {
  scene::Scene scene = scene::load_scene(o.scene);
  if (!o.model.empty() && scene.virtual_tool() && o.model != scene.contact.model)
    throw std::runtime_error(fmt::format("A virtual tool requires contact model {}, not {}",
                                         scene.contact.model, o.model));
  if (!o.model.empty())
    scene.contact.model = o.model;
  console::log("building {}\n", scene.name);
  const std::unique_ptr<rendering::BuiltScene> built =
      scene_build::build_here(scene, {.who = "plan"});
  PlanReport report;
  report.plan = built->plan();
  for (rendering::PlanPart& part : rendering_node::ring_parts(scene))
    report.plan.parts.push_back(std::move(part));
  MeasureOptions options{.frames = o.frames, .cpu_time_s = thread_cpu_s, .coupling = {}};
  if (!scene.design)
    options.coupling = scene.coupling;
  if (!o.device.empty())
    report.device = judge(o, scene, *built, options.coupling);
  if (o.no_measure)
    return report;
  if (!options.coupling)
    report.no_coupling_time_reason =
        report.device
            ? "The coupling's time is not measured: no coupling is allowed."
            : "The coupling's time is not measured: its design needs a device (--device).";
  console::log("measuring {} frames\n", o.frames);
  report.machine = this_machine(), report.load = load_average();
  report.times = measure_plan(scene, *built, options);
  return report;
}

int run(const PlanVerb& o) {
  const PlanReport report = make_report(o);
  console::print_result("{}", o.json ? to_json(report).dump(2) + "\n" : to_text(report));
  return report.device && !report.device->errors.empty() ? 1 : 0;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  auto o = std::make_shared<PlanVerb>();
  CLI::App* verb = app.add_subcommand("plan");
  verb->add_option("SCENE", o->scene, "Scene file (YAML), or the name of a shipped scene")
      ->required()
      ->transform(runtime::scene_argument());
  verb->add_option("--device", o->device,
                   "Checks the scene for this device: a name, or a file (deploy/devices/*.yaml)");
  verb->add_option("--model", o->model, "Contact model instead of the scene's")
      ->check(CLI::IsMember({"original", "adapted", "field"}));
  verb->add_option("--frames", o->frames, "Number of measured frames")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  verb->add_flag("--no-measure", o->no_measure,
                 "Prints expected times only; the output is the same on every machine");
  verb->add_flag("--json", o->json, "Prints one JSON object on stdout, the rest on stderr");
  verb->callback([o, &action] { action = [o] { return run(*o); }; });
}

}  // namespace voxtouch::cli
