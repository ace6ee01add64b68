#pragma once
/// Input of the designer for `voxtouch design` and the Python package.
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/rendering/build.hpp"
#include "nodes/cli/design/design_report.hpp"

namespace voxtouch::cli {

struct DesignInput {
  std::filesystem::path
      scene;  ///< with the contact and the design goals; empty: the device's limit
  std::string
      hand;  ///< pen, arm or any_passive; empty: the scene's, else how the device is gripped
  std::string kind = "auto";  ///< shaping_filter, spring_damper or direct
  double cutoff_hz = 5.0, gain_margin = 2.0;
  double stiffness_n_per_m =
      0.0;  ///< without a scene: the contact's, at the hand; 0: the device's largest
  std::optional<double> min_damping_ratio;  ///< with a hand; none: the scene's, or the standard
  std::optional<double>
      damping_force_ratio;  ///< as CouplingSpec has it; none: the scene's, or the standard
  bool gripped = false, no_damping = false;
  bool no_velocity_windows = false;
};

/// The problem without a scene: whatever the device can show, or the stiffness given, in one
/// contact that may be capped.
coupling::design::DesignProblem problem_for_device(const DesignInput& input,
                                                   const coupling::design::DeviceModel& device);

/// How a scene is built.
using BuildScene = std::function<std::unique_ptr<rendering::BuiltScene>(const scene::Scene&)>;

/// Builds the scene, if any, and designs for it. Takes seconds. Throws as reading and building a
/// scene do.
DesignReport work_out(const DesignInput& input, const coupling::design::DeviceModel& device,
                      const BuildScene& build);

}  // namespace voxtouch::cli
