#include "nodes/cli/design/design_input.hpp"

#include <fmt/format.h>

#include "core/device_fit/design_problem.hpp"
#include "core/device_fit/fit_coupling.hpp"
#include "core/scene/scene_file.hpp"

namespace voxtouch::cli {
namespace {

std::string hand_text(const coupling::design::OperatorRange& hand, const std::string& name) {
  const coupling::design::HandRange& h = hand.translation;
  if (h.any_passive)
    return "any passive hand";
  return fmt::format("{}: {:.3g} to {:.3g} kg, {:.3g} to {:.3g} Ns/m, {:.4g} to {:.4g} N/m{}", name,
                     h.mass_min, h.mass_max, h.damping_min, h.damping_max, h.stiffness_min,
                     h.stiffness_max, h.may_release ? ", or released" : ", always gripped");
}

}  // namespace

coupling::design::DesignProblem problem_for_device(const DesignInput& input,
                                                   const coupling::design::DeviceModel& device) {
  scene::Scene scene;
  scene.voxel_size_m = 0.0;
  scene.design.emplace();
  const double most =
      input.stiffness_n_per_m > 0 ? input.stiffness_n_per_m : device.translation.max_stiffness;
  const double most_rotation = device.gives_torque ? device.rotation.max_stiffness : 0.0;
  return device_fit::design_problem(scene, device, {0.01 * most, most},
                                    {0.01 * most_rotation, most_rotation});
}

namespace {

/// The command line overrides the scene.
void apply(const DesignInput& input, const coupling::design::DeviceModel& device,
           coupling::design::DesignProblem& problem, std::string& hand) {
  if (!input.hand.empty()) {
    scene::DesignOptions options;
    coupling::design::Grip grip = device.grip;
    if (input.hand == "any_passive")
      options.hand = scene::HandOption::kAnyPassive;
    else
      coupling::design::parse_grip(input.hand, grip);
    problem.hand = scene::operator_range(options, grip);
    hand = input.hand;
  }
  if (input.min_damping_ratio)
    problem.goals.min_damping = coupling::design::min_damping_ratios_of(*input.min_damping_ratio);
  if (input.damping_force_ratio)
    problem.goals.damping_force_ratio = *input.damping_force_ratio;
  if (input.gripped)
    problem.hand.translation.may_release = problem.hand.rotation.may_release = false;
  if (input.no_velocity_windows)
    problem.goals.velocity_windows = false;
  if (input.no_damping)
    problem.goals.allow_injected_damping = false;
}

/// The parts of a scene that the force preview needs.
struct PreviewInput {
  scene::Scene scene;
  rendering::StiffnessBounds bounds;
  double tool_reach_m = 0.0;
};

/// The design problem of the command line and its scene, with its texts, before the design.
DesignReport problem_of(const DesignInput& input, const coupling::design::DeviceModel& device,
                        const BuildScene& build, std::optional<PreviewInput>& preview) {
  DesignReport out;
  out.device = device.name;
  std::string hand = std::string(coupling::design::name_of(device.grip));
  if (input.scene.empty()) {
    out.problem = problem_for_device(input, device);
    out.contact = fmt::format("up to {:.4g} N/m (no scene given; the coupling may cap it)",
                              out.problem.contact.all_points);
  } else {
    const scene::Scene scene = scene::load_scene(input.scene);
    const auto built = build(scene);
    const rendering::Plan& plan = built->plan();
    out.problem =
        device_fit::design_problem(scene, device, plan.contact_n_per_m, plan.contact_nm_per_rad);
    preview = {scene, {plan.contact_n_per_m, plan.contact_nm_per_rad}, plan.tool_reach_m};
    if (scene.design)
      hand = std::string(scene::name_of(scene.design->hand));
    const bool spring = rendering::is_spring({plan.contact_n_per_m, plan.contact_nm_per_rad});
    out.contact = spring ? fmt::format(
                               "scene {}: spring of the virtual tool, up to {:.4g} N/m (the "
                               "device's limit), at the hand",
                               scene.name, out.problem.contact.all_points)
                         : fmt::format(
                               "scene {}: one point {:.4g} N/m, all points at most {:.4g} N/m ({} "
                               "points), at the hand",
                               scene.name, out.problem.contact.one_point,
                               out.problem.contact.all_points, plan.shell_points);
    if (const effects::EffectSpec* external = effects::external_of(scene.effects))
      out.contact += ". " + effects::no_certificate_sentence(external->name);
  }
  if (input.scene.empty() || input.kind != "auto")
    out.problem.goals.kind = input.kind;
  if (input.scene.empty() || input.cutoff_hz != 5.0)
    out.problem.goals.cutoff_hz = input.cutoff_hz;
  if (input.scene.empty() || input.gain_margin != 2.0)
    out.problem.goals.gain_margin = input.gain_margin;
  apply(input, device, out.problem, hand);
  out.hand = hand_text(out.problem.hand, hand);
  return out;
}

std::optional<device_fit::ForcePreview> preview_of(const PreviewInput& input,
                                                   const coupling::design::DeviceModel& device,
                                                   const coupling::design::Design& design) {
  device_fit::FittedCoupling fitted;
  fitted.spec = device_fit::spec_W(design, input.scene), fitted.design = design,
  fitted.designed = true;
  if (design.status == coupling::design::DesignStatus::kInfeasible)
    return std::nullopt;
  return device_fit::force_preview(fitted, input.scene, device, input.bounds, input.tool_reach_m);
}

}  // namespace

DesignReport work_out(const DesignInput& input, const coupling::design::DeviceModel& device,
                      const BuildScene& build) {
  std::optional<PreviewInput> preview;
  DesignReport report = problem_of(input, device, build, preview);
  report.design = coupling::design::design_coupling(report.problem);
  if (preview)
    report.preview = preview_of(*preview, device, report.design);
  report.certificate = coupling::design::certify_contacts(report.problem, report.design);
  report.paper = judge_paper_recipe(report.problem);
  report.region = region_round(report.problem, report.design);
  report.law = region_of_law(report.problem, report.design);
  return report;
}

}  // namespace voxtouch::cli
