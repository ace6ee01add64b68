#include "nodes/cli/up/up_checks.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "core/felt/felt.hpp"
#include "core/fitting/device_check.hpp"
#include "core/fitting/fit_coupling.hpp"
#include "core/scene/device_workspace.hpp"
#include "core/types/device_description.hpp"
#include "devices/registry.hpp"
#include "nodes/cli/up/summary.hpp"
#include "nodes/device/described_device.hpp"
#include "nodes/device/device_node.hpp"
#include "nodes/device/recording.hpp"
#include "nodes/faults/force_lock.hpp"
#include "nodes/runtime/signals.hpp"
#include "nodes/scene_build/build_here.hpp"

namespace voxtouch::cli {
namespace {

void check_bag(const std::filesystem::path& bag) {
  if (bag.empty())
    return;
  std::error_code ignored;
  if (std::filesystem::exists(bag, ignored))
    throw std::runtime_error(fmt::format(
        "the bag folder {} exists already and is left as it is; choose another with --record",
        bag.string()));
  std::filesystem::path parent = std::filesystem::absolute(bag).parent_path();
  while (!std::filesystem::exists(parent, ignored) && parent.has_relative_path())
    parent = parent.parent_path();
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error(fmt::format(
        "no bag can be made in {} ({}); choose another folder with --record, or --no-record",
        parent.string(), std::strerror(errno)));
}

/// Ctrl-C ends it: there is nothing to stop in order yet.
std::unique_ptr<rendering::BuiltScene> build_unless_stopped(
    const scene::Scene& scene, const scene_build::CacheOptions& cache) {
  const auto go_on = [] {
    if (runtime::stop_requested().load(std::memory_order_relaxed))
      throw std::runtime_error("stopped before the start");
  };
  return scene_build::build_here(scene, {.who = "up", .cache = cache, .go_on = go_on});
}

/// `felt`: what will be felt. What the coupling node will say of this device and scene, by its own
/// code: a sentence; empty: it will command forces. What all points show together is known only of
/// the scene as built, so it is built here as well.
std::string why_no_force(const scene::Scene& scene, const DeviceDescription& description,
                         const std::string& motion, const scene_build::CacheOptions& cache,
                         std::string& felt, std::vector<std::string>& warnings) {
  if (std::string wrong = what_is_wrong(description); !wrong.empty())
    return wrong;
  const std::unique_ptr<rendering::BuiltScene> built = build_unless_stopped(scene, cache);
  const rendering::Plan& plan = built->plan();
  for (const std::string& warning : plan.warnings)
    if (std::ranges::find(warnings, warning) == warnings.end())
      warnings.push_back(warning);
  const coupling::design::DeviceModel device = coupling::design::model_of(description);
  const rendering::StiffnessBounds bounds{plan.contact_n_per_m, plan.contact_nm_per_rad};
  const fitting::FittedCoupling fitted =
      fitting::fit_coupling(scene, device, bounds, fitting::demand_of(scene));
  felt = felt::felt_sentence(fitted, scene, device, *built, motion, felt::Search::kKnown);
  return fitted.refusal;
}

/// What is told of a run in more than so many samples of it.
struct SampleNote {
  const char* figure;  ///< of the rendering
  double most;
  const char* what;
  bool with_virtual_tool = true;
};
constexpr SampleNote kSampleNotes[] = {
    {"buried_samples", 100,
     "the tool was wholly inside a static object, where there is no direction to push: does the "
     "motion start inside?"},
    {"unplaced_samples", 100,
     "there was no virtual tool, for the hand was inside a static object since it came in without "
     "one, or the coupling was still being designed: nothing was felt"},
    {"lag_samples", 0,
     "the hand was too fast for the virtual tool, or an object moved more than half a voxel"},
    {"over_budget_samples", 0,
     "a frame took longer than the scene's budget_us by a tenth, by the clock, which counts other "
     "work on the machine too"},
    {"cut_short_samples", 0,
     "the time budget ended a frame before the virtual tool had come to its place; it went on in "
     "the next"},
    {"saturated_samples", 0,
     "the tool was so deep, or a wall so thin, that going deeper meets no more force: more "
     "stiffness, a thicker body or a stronger "
     "device holds it out",
     false},
};

}  // namespace

std::vector<std::string> check_before_start(const scene::Scene& scene, const Plans& plans,
                                            std::vector<std::string>& warnings) {
  devices::DeviceOptions options;
  options.settings = plans.settings;
  const std::optional<scene::DeviceFile> file = device_node::described_device(plans.device);
  if (file)
    options.described = file->description;
  options.recorded = device_node::recorded_hand(plans.device, plans.settings);
  DeviceDescription description = devices::describe_device(plans.device, options);
  description.network_delay_s = 1e-3 * plans.network_delay_ms;
  const Motion motion = device_node::choose_motion(scene, plans.motion);
  check_bag(plans.bag);
  std::string felt;
  if (const std::string why =
          why_no_force(scene, description, plans.motion, plans.cache, felt, warnings);
      !why.empty())
    throw std::runtime_error(
        fmt::format("{} does not go with {}: {}", scene.file.string(), plans.device, why));
  std::vector<std::string> notes;
  if (!scene.design)
    notes = fitting::check_device(scene, coupling::design::model_of(description),
                                  fitting::least_stiffness_n_per_m(scene))
                .warnings;
  if (!felt.empty())
    notes.insert(notes.begin(), std::move(felt));
  if (file) {
    notes.push_back(scene::assumed_sentence(*file));
    const Motion tip = motion_in_device(motion, scene.device.pose_WD, scene.device.pose_PT,
                                        scene.device.position_scale);
    notes.push_back(file->workspace_m
                        ? scene::beyond_workspace(tip, *file->workspace_m, description.model)
                        : "");
    std::erase(notes, "");
  }
  if (const effects::EffectSpec* external = effects::external_of(scene.effects))
    notes.push_back(
        plans.lockstep
            ? fmt::format("in lockstep the effect '{}' gives nothing: a value from outside comes "
                          "at the wall's time, and no two runs would be the same",
                          external->name)
            : effects::no_certificate_sentence(external->name));
  if (options.recorded)
    notes.push_back(device_node::about(*options.recorded, plans.device));
  const bool simulated_hand = devices::has_simulated_hand(plans.device);
  if (!simulated_hand && !plans.motion.empty())
    notes.push_back(fmt::format("--motion {} moves a simulated hand; {} is moved by {}",
                                plans.motion, plans.device,
                                options.recorded ? "a recorded one" : "a person"));
  if (simulated_hand && plans.motion.empty())
    notes.push_back(
        "no --motion is given: the simulated hand rests where the scene's first motion starts");
  return notes;
}

namespace {

/// What nobody vouches for, and what came of it.
void say_external(RunSummary& s) {
  const std::string about = word(s.reports, "rendering", "external");
  if (about.empty())
    return;
  const auto count = [&](const char* figure) {
    return runtime::as_count(number(s.reports, "rendering", figure));
  };
  s.notes.push_back(fmt::format(
      "{} Felt were {} of its values, which gave the hand {:.3g} J in all; refused were {} of "
      "other writers, {} that held a number that is none and {} in a frame that is not known.",
      about, count("external_samples"), number(s.reports, "rendering", "external_given_j"),
      count("external_foreign"), count("external_not_finite"), count("external_wrong_frame")));
}

}  // namespace

void judge(RunSummary& s) {
  say_external(s);
  const auto message = [&](const std::string& node) { return s.reports[node].message; };
  if (const double n = number(s.reports, "validator", "disagree"); n > 0)
    s.problems.push_back(
        fmt::format("the validator disagrees with {} samples: {}", n, message("validator")));
  if (const double n = number(s.reports, "device", "foreign_commands"); n > 0)
    s.problems.push_back(
        fmt::format("{} commands of a second writer were ignored ({})", n, message("device")));
  if (const double n = number(s.reports, "logger", "refused_records"); n > 0)
    s.problems.push_back(
        fmt::format("{} records of a second writer are not in the bag ({})", n, message("logger")));
  for (const char* node : {"device", "coupling", "coupling_standby"})
    if (const double n = number(s.reports, node, faults::ForceLock::kCount); n > 0)
      s.problems.push_back(fmt::format(
          "the {} locked itself at zero force {}x: its fault records tell what it saw before", node,
          n));
  const double felt = number(s.reports, "coupling", "stiffness_at_hand_n_per_m"),
               most = number(s.reports, "coupling", "device_max_stiffness_n_per_m");
  if (most > 0 && felt > most)
    s.problems.push_back(fmt::format(
        "all points in contact together showed {:.0f} N/m at the hand, more than the {:.0f} N/m "
        "that {} can show "
        "stably: lower the contact's stiffness, the coupling's gain or a scale of the device",
        felt, most, s.device));
  if (const std::string bag = word(s.reports, "device", "recorded"); !bag.empty())
    s.problems.push_back(
        fmt::format("the hand was a recording ({}) that no force moved: the loop was open, and the "
                    "run says nothing of it",
                    bag));
  if (s.problems.empty() && number(s.reports, "device", "samples") == 0)
    s.problems.push_back("the device gave no sample");
  const double zero_force = number(s.reports, "device", "zero_force_samples"),
               interruptions = number(s.reports, "device", "interruptions");
  const std::string trouble = word(s.reports, "device", "trouble");
  if (zero_force > 0 && zero_force >= number(s.reports, "device", "samples"))
    s.problems.push_back(fmt::format("{} took no force in the whole run: {}", s.device, trouble));
  else if (interruptions > 0)
    s.notes.push_back(
        fmt::format("{} gave no force in {} samples (lost {}x on the way); the last reason: {}",
                    s.device, zero_force, interruptions, trouble));
  s.judged = judge_figures(figures_of(s), s.limits);
  for (const Judged& judged : s.judged)
    if (!judged.met)
      s.problems.push_back(judged.sentence);
  for (const SampleNote& note : kSampleNotes)
    if (const double n = number(s.reports, "rendering", note.figure);
        n > note.most && (note.with_virtual_tool || !has_virtual_tool(s)))
      s.notes.push_back(fmt::format("in {} samples {}", n, note.what));
  std::vector<std::string> unique;
  for (std::string& p : s.problems)
    if (std::find(unique.begin(), unique.end(), p) == unique.end())
      unique.push_back(std::move(p));
  s.problems = std::move(unique);
}

}  // namespace voxtouch::cli
