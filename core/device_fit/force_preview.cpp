#include "core/device_fit/force_preview.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/device_fit/design_problem.hpp"

namespace voxtouch::device_fit {
namespace {

constexpr std::array<std::pair<StiffnessLimit, std::string_view>, 5> kNames{
    {{StiffnessLimit::kDevice, "device"},
     {StiffnessLimit::kRequested, "requested"},
     {StiffnessLimit::kLever, "lever"},
     {StiffnessLimit::kLoop, "loop"},
     {StiffnessLimit::kSetByHand, "set_by_hand"}}};
constexpr double kAlmost = 0.999;

/// At the hand; 0: the tool rotates with the hand only.
double rotation_of_spring(const FittedCoupling& fitted, const scene::Scene& scene,
                          const coupling::design::DeviceModel& device,
                          const rendering::StiffnessBounds& bounds, double spring_n_per_m) {
  const double to_hand = hand_scales(scene.device).rotation;
  if (spring_n_per_m > 0.0)
    return to_hand * spring_n_per_m * bounds.rotation.one_point / bounds.translation.one_point;
  if (!effects::needs_of(scene.effects).body) {
    const double compliance = series_spring(fitted, scene, device, bounds, bounds).rotation;
    return compliance > 0.0 ? to_hand / compliance : 0.0;
  }
  return 0.0;
}

/// At the hand, if the scene requests more than is certified; otherwise 0.
double grip_of(const scene::Scene& scene, const rendering::StiffnessBounds& bounds,
               double certified_n_per_m) {
  if (!effects::needs_of(scene.effects).body)
    return 0.0;
  const double grip = hand_scales(scene.device).translation * bounds.translation.all_points;
  return certified_n_per_m < kAlmost * grip ? grip : 0.0;
}

}  // namespace

std::string_view name_of(StiffnessLimit limit) noexcept {
  return std::ranges::find(kNames, limit, &std::pair<StiffnessLimit, std::string_view>::first)
      ->second;
}

std::optional<StiffnessLimit> stiffness_limit_of(std::string_view name) noexcept {
  const auto found =
      std::ranges::find(kNames, name, &std::pair<StiffnessLimit, std::string_view>::second);
  if (found == kNames.end())
    return std::nullopt;
  return found->first;
}

std::optional<ForcePreview> force_preview(const FittedCoupling& fitted, const scene::Scene& scene,
                                          const coupling::design::DeviceModel& device,
                                          const rendering::StiffnessBounds& bounds,
                                          double tool_reach_m) {
  if (!fitted.refusal.empty())
    return std::nullopt;
  const coupling::design::AxisDesign& along = fitted.design.translation;
  ForcePreview out{.stiffness_n_per_m = along.displayed_stiffness,
                   .gain_margin = along.gain_margin,
                   .force_n = device.translation.max_effort,
                   .depth_m = 0.0,
                   .limit = StiffnessLimit::kLoop};
  out.returns_torque = device.gives_torque;
  const auto at_hand = [&](double spring) {
    return stiffness_at_hand_n_per_m(fitted.spec, scene.device, spring);
  };
  const double spring = spring_n_per_m(fitted, scene, device, bounds);
  if (spring > 0.0)
    out.stiffness_n_per_m = at_hand(spring);
  if (!(out.stiffness_n_per_m > 0.0))
    return std::nullopt;
  if (out.stiffness_n_per_m >= kAlmost * device.translation.max_stiffness)
    out.limit = StiffnessLimit::kDevice;
  else if (!fitted.designed)
    out.limit = StiffnessLimit::kSetByHand;
  else if (spring > 0.0 &&
           spring < kAlmost * spring_n_per_m(fitted, scene, device, {bounds.translation, {}}))
    out.limit = StiffnessLimit::kLever;
  else if (along.displayed_stiffness >= kAlmost * along.requested_stiffness)
    out.limit = StiffnessLimit::kRequested;
  out.depth_m = out.force_n / out.stiffness_n_per_m;
  out.rotation_nm_per_rad = rotation_of_spring(fitted, scene, device, bounds, spring);
  out.reach_m = tool_reach_m;
  out.grip_n_per_m = grip_of(scene, bounds, out.stiffness_n_per_m);
  return out;
}

double ForcePreview::across_n_per_m() const noexcept {
  if (!(rotation_nm_per_rad > 0.0))
    return stiffness_n_per_m;
  return 1.0 / (1.0 / stiffness_n_per_m + reach_m * reach_m / rotation_nm_per_rad);
}

}  // namespace voxtouch::device_fit
