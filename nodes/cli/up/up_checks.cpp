#include "nodes/cli/up/up_checks.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "core/device_fit/device_check.hpp"
#include "core/scene/device_workspace.hpp"
#include "core/types/device_description.hpp"
#include "devices/registry.hpp"
#include "nodes/device/described_device.hpp"
#include "nodes/device/device_node.hpp"

namespace voxtouch::cli {
namespace {

void check_bag(const std::filesystem::path& bag) {
  if (bag.empty())
    return;
  std::error_code ignored;
  if (std::filesystem::exists(bag, ignored))
    throw std::runtime_error(fmt::format(
        "Folder {} exists and is not overwritten. Choose another with --record", bag.string()));
  std::filesystem::path parent = std::filesystem::absolute(bag).parent_path();
  while (!std::filesystem::exists(parent, ignored) && parent.has_relative_path())
    parent = parent.parent_path();
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    throw std::runtime_error(fmt::format(
        "Cannot create a recording in {} ({}). Choose another folder with --record, or --no-record",
        parent.string(), std::strerror(errno)));
}

/// Reasons for which the coupling node refuses this device for every contact; empty if none.
/// Rendering and coupling check what depends on the built scene; the run then ends before any
/// force.
std::string refused_unbuilt(const scene::Scene& scene, const DeviceDescription& description) {
  if (std::string wrong = validate(description); !wrong.empty())
    return wrong;
  return device_fit::force_not_displayed(
      scene, scene.design ? nullptr : &scene.coupling, coupling::design::model_of(description),
      device_fit::least_stiffness_n_per_m(scene), device_fit::demand_of(scene));
}

/// The figures of a measured file. For hardware its node compares the file with what the open
/// device reports.
DeviceDescription measured(const Plans& plans, const DeviceDescription& description,
                           std::vector<std::string>& notes) {
  const scene::DeviceFile file = scene::load_device_file(plans.device_file);
  if (devices::has_simulated_hand(plans.device))
    device_node::require_same_device(plans.device_file, file, description, {});
  notes.push_back(
      file.measured
          ? scene::measured_sentence(file) +
                "; the mass is that of the start pose, and the certificate covers no lighter one"
          : fmt::format("{} names no measurement: its figures are assumed",
                        plans.device_file.string()));
  return scene::measured_device(file, description);
}

}  // namespace

std::string does_not_go_with(const std::filesystem::path& scene, const std::string& device,
                             const std::string& why) {
  return fmt::format("{} cannot run on {}: {}", scene.string(), device, why);
}

std::vector<std::string> check_before_start(const scene::Scene& scene, const Plans& plans) {
  devices::DeviceOptions options;
  options.settings = plans.settings;
  const std::optional<scene::DeviceFile> file = device_node::described_device(plans.device);
  if (file)
    options.described = file->description;
  DeviceDescription description = devices::describe_device(plans.device, options);
  description.network_delay_s = 1e-3 * plans.network_delay_ms;
  std::vector<std::string> notes;
  if (!plans.device_file.empty())
    description = measured(plans, description, notes);
  const Motion motion = device_node::choose_motion(scene, plans.motion);
  check_bag(plans.bag);
  if (const std::string why = refused_unbuilt(scene, description); !why.empty())
    throw std::runtime_error(does_not_go_with(scene.file, plans.device, why));
  if (!scene.design)
    std::ranges::copy(device_fit::check_device(scene, coupling::design::model_of(description),
                                               device_fit::least_stiffness_n_per_m(scene))
                          .warnings,
                      std::back_inserter(notes));
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
    notes.push_back(plans.lockstep
                        ? fmt::format("Effect '{}' is inactive in lockstep: external values arrive "
                                      "in wall time, so runs would not be repeatable",
                                      external->name)
                        : effects::no_certificate_sentence(external->name));
  const bool simulated_hand = devices::has_simulated_hand(plans.device);
  if (!simulated_hand && !plans.motion.empty())
    notes.push_back(
        fmt::format("--motion {} has no effect: it needs a simulated hand, and {} is a real device",
                    plans.motion, plans.device));
  if (simulated_hand && plans.motion.empty() && !plans.hand_from_page)
    notes.push_back(
        "No --motion: the simulated hand rests at the start of the scene's first motion");
  return notes;
}

}  // namespace voxtouch::cli
