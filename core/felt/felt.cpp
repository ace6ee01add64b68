#include "core/felt/felt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/fitting/design_problem.hpp"

namespace voxtouch::felt {
namespace {

constexpr double kDepthM = 0.01, kLittle = 0.2;  ///< a share of the device's force

/// " More: ... Or: ...": one change, or two where little is felt.
std::string told(const std::vector<std::string>& changes, double share) {
  std::string text;
  const std::size_t most = std::min<std::size_t>(share < kLittle ? 2 : 1, changes.size());
  for (std::size_t n = 0; n < most; ++n) text += (n == 0 ? " More: " : " Or: ") + changes[n];
  return text;
}

}  // namespace

std::string felt_of_spring(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                           const rendering::StiffnessBounds& bounds) {
  if (!rendering::is_spring(bounds) || !fitted.refusal.empty()) return {};
  const double shown = fitting::spring_n_per_m(fitted, scene, device, bounds);
  const double at_hand = fitting::stiffness_at_hand_n_per_m(fitted.spec, scene.device, shown);
  const double most = device.translation.max_effort, force = std::min(at_hand * kDepthM, most), share = force / most;
  if (!(at_hand > 0.0)) return {};
  std::string text = fmt::format(
      "What will be felt: {:.4g} N/m at the hand, certified with a margin of {:.3g}: {:.3g} N with the hand 10 mm deep, {:.0f} % of the {:.3g} N "
      "that {} gives, which it reaches {:.3g} mm deep.",
      at_hand, fitted.design.translation.gain_margin, force, 100.0 * share, most, device.name, 1e3 * most / at_hand);
  if (!fitted.designed) return text;
  const double turning = fitting::spring_n_per_m(fitted, scene, device, {bounds.translation, {}});
  if (turning > 1.001 * shown)
    text += fmt::format(" Turning limits it: a tool.lever_m of {:.1f} mm or less gives {:.4g} N/m.",
                        1e3 * std::sqrt(shown / turning * bounds.rotation.one_point / bounds.translation.one_point), turning);
  if (!fitted.design.reasons.empty()) text += " What limits it: " + fitted.design.reasons.front();
  return text + told(fitted.design.remedies, share);
}

std::string felt_of_grip(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                         double grip_n_per_m) {
  const double at_hand = fitting::stiffness_at_hand_n_per_m(fitted.spec, scene.device, grip_n_per_m);
  if (!fitted.refusal.empty() || !(at_hand > 0.0)) return {};
  const double most = device.translation.max_effort, force = std::min(at_hand * kDepthM, most), share = force / most;
  std::string text = fmt::format(
      "What will be felt: the body while it is held, {:.4g} N/m at the hand: {:.3g} N with the hand 10 mm from where the body hangs, {:.0f} % of the {:.3g} N "
      "that {} gives; nothing of it while it is not held.",
      at_hand, force, 100.0 * share, most, device.name);
  if (at_hand >= 0.999 * fitting::stiffness_at_hand_n_per_m({}, scene.device, grip_n_per_m))
    return text + " What limits it: the body's grip_n_per_m." + told({"a larger grip_n_per_m."}, share);
  if (!fitted.design.reasons.empty()) text += " What limits it: " + fitted.design.reasons.front();
  return text + told(fitted.design.remedies, share);
}

std::string felt_of_penalty(const fitting::FittedCoupling& fitted, const coupling::design::DeviceModel& device,
                            const std::vector<Pressed>& pressed) {
  if (pressed.empty() || !fitted.refusal.empty()) return {};
  const Pressed& deepest = pressed.back();
  const Pressed& most = *std::max_element(pressed.begin(), pressed.end(), [](const Pressed& a, const Pressed& b) { return a.force_n < b.force_n; });
  const double limit = device.translation.max_effort, share = deepest.force_n / limit;
  std::string text = fmt::format("What will be felt: {:.2g} N with the hand {:.0f} mm deep, {:.0f} % of the {:.3g} N that {} gives", deepest.force_n,
                                 1e3 * deepest.depth_m, 100.0 * share, limit, device.name);
  if (most.force_n > 1.05 * deepest.force_n) text += fmt::format("; at most {:.2g} N, {:.0f} mm deep", most.force_n, 1e3 * most.depth_m);
  text += ".";
  std::vector<std::string> changes;
  const double certified = fitted.design.translation.shown_stiffness, of_spring = std::min(certified * deepest.depth_m, limit);
  const bool lacks_depth = deepest.force_n < 0.9 * of_spring;
  if (lacks_depth) {
    text += fmt::format(" What limits it: the {:.4g} N/m that hold here would give {:.2g} N, but the contact itself is as stiff as that only "
                        "some way in, and a stiffer one sooner.", certified, of_spring);
    changes.push_back(fmt::format("contact: {{model: field, rendering: virtual_tool}} with closed meshes, up to {:.2g} N.", of_spring));
  } else if (!fitted.design.reasons.empty()) {
    text += " What limits it: " + fitted.design.reasons.front();
  }
  changes.insert(changes.end(), fitted.design.remedies.begin(), fitted.design.remedies.end());
  return text + told(changes, share);
}

std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          rendering::BuiltScene& built, const Motion& motion) {
  if (const rendering::StiffnessBounds bounds{built.plan().contact_n_per_m, built.plan().contact_nm_per_rad}; rendering::is_spring(bounds))
    return felt_of_spring(fitted, scene, device, bounds);
  if (built.effect_ground().body) return felt_of_grip(fitted, scene, device, built.plan().contact_n_per_m.one_point);
  return felt_of_penalty(fitted, device, press(built, scene, fitted, device, motion));
}

std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          rendering::BuiltScene& built) {
  if (built.effect_ground().body) return felt_of_grip(fitted, scene, device, built.plan().contact_n_per_m.one_point);
  std::string text = felt_of_spring(fitted, scene, device, {built.plan().contact_n_per_m, built.plan().contact_nm_per_rad});
  for (auto motion = scene.motions.begin(); text.empty() && motion != scene.motions.end(); ++motion)
    text = felt_sentence(fitted, scene, device, built, motion->second);
  return text;
}

}  // namespace voxtouch::felt
