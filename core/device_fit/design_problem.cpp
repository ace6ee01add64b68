#include "core/device_fit/design_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace voxtouch::device_fit {
namespace {

/// A range must not begin at zero.
constexpr double kAnyRatio = 1e-6;

/// The scene's caps in W; infinity without a cap.
struct Caps {
  double n_per_m, nm_per_rad;
};
Caps caps_of(const scene::Scene& scene) noexcept {
  if (!scene.design)
    return {scene.coupling.stiffness_cap_n_per_m, scene.coupling.stiffness_cap_nm_per_rad};
  constexpr double kNone = std::numeric_limits<double>::infinity();
  return {scene.design->stiffness_cap_n_per_m.value_or(kNone),
          scene.design->stiffness_cap_nm_per_rad.value_or(kNone)};
}

coupling::design::ContactRange range_D(const coupling::design::ContactRange& range_W, double cap,
                                       double scale) noexcept {
  return {std::min(range_W.one_point, cap) * scale, std::min(range_W.all_points, cap) * scale};
}

/// Bounds of a virtual tool's spring, limited to what the device can display. Caps apply to the
/// spring only, so the designer may use any fraction of it (`one_point`); effects are added.
rendering::StiffnessBounds of_spring(const scene::Scene& scene,
                                     const coupling::design::DeviceModel& device,
                                     const rendering::StiffnessBounds& bounds) noexcept {
  const coupling::design::ContactRange &t = bounds.translation, &r = bounds.rotation;
  const double spring = std::min(t.one_point, largest_spring_n_per_m(scene, device)),
               fraction = spring / t.one_point;
  const double one_point_rotation = fraction * r.one_point;
  return {{kAnyRatio * spring, spring + (t.all_points - t.one_point)},
          {kAnyRatio * one_point_rotation, one_point_rotation + (r.all_points - r.one_point)}};
}

/// Multiplies all stiffnesses and dampings by `scales`.
coupling::CouplingSpec scaled(coupling::CouplingSpec spec, const HandScales& scales) noexcept {
  spec.stiffness_n_per_m *= scales.translation;
  spec.damping_ns_per_m *= scales.translation;
  spec.stiffness_cap_n_per_m *= scales.translation;
  spec.injected_damping_ns_per_m *= scales.translation;
  spec.velocity_band_m_per_s *= std::sqrt(scales.rotation / scales.translation);
  spec.damping_force_offset_n *= std::sqrt(scales.translation * scales.rotation);
  spec.stiffness_cap_nm_per_rad *= scales.rotation;
  spec.injected_damping_nms_per_rad *= scales.rotation;
  return spec;
}

}  // namespace

HandScales hand_scales(const scene::WorkspaceMapping& device) noexcept {
  return {device.position_scale * device.force_scale, device.force_scale / device.position_scale};
}

coupling::design::DesignProblem design_problem(const scene::Scene& scene,
                                               const coupling::design::DeviceModel& device,
                                               const coupling::design::ContactRange& translation_W,
                                               const coupling::design::ContactRange& rotation_W) {
  const scene::DesignOptions options = scene.design.value_or(scene::DesignOptions{});
  const HandScales scales = hand_scales(scene.device);
  const Caps caps = caps_of(scene);
  coupling::design::DesignProblem problem;
  problem.device = device;
  problem.hand = scene::operator_range(options, device.grip);
  rendering::StiffnessBounds bounds{translation_W, rotation_W};
  const bool spring = rendering::is_spring(bounds);
  if (spring)
    bounds = of_spring(scene, device, bounds);
  problem.contact = range_D(bounds.translation, caps.n_per_m, scales.translation);
  problem.contact_rotation = range_D(bounds.rotation, caps.nm_per_rad, scales.rotation);
  coupling::design::DesignGoals& goals = problem.goals;
  goals.kind = options.kind;
  goals.cutoff_hz = options.cutoff_hz;
  goals.max_cutoff_hz = std::max(goals.max_cutoff_hz, options.cutoff_hz);
  goals.gain_margin = options.gain_margin;
  goals.min_damping = coupling::design::min_damping_ratios_of(options.min_damping_ratio);
  goals.rotation_min_damping =
      coupling::design::min_damping_ratios_of(options.rotation_min_damping_ratio);
  if (!spring)
    goals.force_layer_depth_m = 0.5 * scene.voxel_size_m / scene.device.position_scale;
  goals.allow_injected_damping = options.inject_damping;
  goals.velocity_windows = options.velocity_windows;
  goals.damping_force_ratio = options.damping_force_ratio;
  goals.free_cap =
      scene.design && !options.stiffness_cap_n_per_m && !options.stiffness_cap_nm_per_rad;
  return problem;
}

double largest_spring_n_per_m(const scene::Scene& scene,
                              const coupling::design::DeviceModel& device) noexcept {
  return device.translation.max_stiffness / hand_scales(scene.device).translation;
}

coupling::CouplingSpec spec_W(const coupling::design::Design& design,
                              const scene::Scene& scene) noexcept {
  const HandScales scales = hand_scales(scene.device);
  const Caps caps = caps_of(scene);
  coupling::CouplingSpec spec =
      scaled(design.spec, {1.0 / scales.translation, 1.0 / scales.rotation});
  spec.stiffness_cap_n_per_m = std::min(spec.stiffness_cap_n_per_m, caps.n_per_m);
  spec.stiffness_cap_nm_per_rad = std::min(spec.stiffness_cap_nm_per_rad, caps.nm_per_rad);
  return spec;
}

coupling::CouplingSpec spec_D(const coupling::CouplingSpec& spec_W,
                              const scene::WorkspaceMapping& device) noexcept {
  return scaled(spec_W, hand_scales(device));
}

double stiffness_at_hand_n_per_m(const coupling::CouplingSpec& spec,
                                 const scene::WorkspaceMapping& device,
                                 double bound_n_per_m) noexcept {
  return coupling::displayed_stiffness_n_per_m(spec, bound_n_per_m) *
         hand_scales(device).translation;
}

coupling::CouplingLimits limits_W(const scene::WorkspaceMapping& scales,
                                  const coupling::design::DeviceModel& device) noexcept {
  const double max_torque_nm = device.gives_torque ? device.rotation.max_effort : 0.0;
  const coupling::design::AxisModel& axis = device.translation;
  return {.max_force_n = axis.max_effort / scales.force_scale,
          .max_torque_nm = max_torque_nm * scales.position_scale / scales.force_scale,
          .resolution_m = axis.resolution * scales.position_scale,
          .damping_ns_per_m = axis.damping / hand_scales(scales).translation,
          .coulomb_friction_n = axis.coulomb_friction / scales.force_scale,
          .delay_s = device.timing.delay_s,
          .force_lag_s = 1.0 / (2.0 * std::numbers::pi * axis.effort_bandwidth_hz)};
}

}  // namespace voxtouch::device_fit
