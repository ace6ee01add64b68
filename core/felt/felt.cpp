#include "core/felt/felt.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/fitting/design_problem.hpp"

namespace voxtouch::felt {
namespace {

constexpr double kLittle = 0.2;  ///< a share of the device's force

/// " More: ... gives ... Or: ...".
std::string told(const Felt& felt, double force, rendering::BuiltScene& built, const Motion* motion,
                 Search search) {
  const double most = felt.device.translation.max_effort;
  if (force >= 0.999 * most)
    return "";
  const bool little = force < kLittle * most;
  const std::vector<Change> found =
      changes(felt, force, built, motion, little ? 2 : 1,
              little && search == Search::kKnown ? Search::kFirst : search);
  std::string text;
  for (const Change& change : found)
    text += fmt::format(" {}: {} gives {:.3g} N.", text.empty() ? "More" : "Or", change.what,
                        change.force_n);
  if (little || search == Search::kAll) {
    if (found.empty())
      return " More: no single change of scene, delay or rate gives a tenth more.";
    return little && found.size() < 2
               ? text + " No other single change of scene, delay or rate gives a tenth more."
               : text;
  }
  return found.empty() ? " More: voxtouch plan with this device tells it." : text;
}

std::string limited(const std::string& what) {
  return what.empty() ? "" : " What limits it: " + what;
}

std::string of_spring(const Felt& felt, double force) {
  const double at_hand = stiffness_n_per_m(felt), most = felt.device.translation.max_effort;
  const rendering::StiffnessBounds bounds = bounds_of(felt);
  std::string text = fmt::format(
      "What will be felt: {:.4g} N/m at the hand, certified with a margin of {:.3g}: {:.3g} N with "
      "the hand 10 mm deep, {:.0f} % of the {:.3g} N "
      "that {} gives, which it reaches {:.3g} mm deep.",
      at_hand, felt.fitted.design.translation.gain_margin, force, 100.0 * force / most, most,
      felt.device.name, 1e3 * most / at_hand);
  if (force < 0.999 * most &&
      fitting::spring_n_per_m(felt.fitted, felt.scene, felt.device, {bounds.translation, {}}) >
          1.001 * fitting::spring_n_per_m(felt.fitted, felt.scene, felt.device, bounds))
    return text + limited("turning, which a virtual tool's spring resists with the tool's lever.");
  return text + limited(limit_of(felt.fitted, felt.device, at_hand, force));
}

std::string of_grip(const Felt& felt, double force) {
  const double at_hand = stiffness_n_per_m(felt), most = felt.device.translation.max_effort,
               grip = bounds_of(felt).translation.one_point;
  const std::string text = fmt::format(
      "What will be felt: the body while it is held, {:.4g} N/m at the hand: {:.3g} N with the "
      "hand 10 mm from where the body hangs, {:.0f} % of the {:.3g} N "
      "that {} gives; nothing of it while it is not held.",
      at_hand, force, 100.0 * force / most, most, felt.device.name);
  const bool by_grip =
      at_hand >= 0.999 * fitting::stiffness_at_hand_n_per_m({}, felt.scene.device, grip);
  return text + limited(by_grip ? "the body's grip_n_per_m."
                                : limit_of(felt.fitted, felt.device, at_hand, force));
}

std::string of_pressed(const Felt& felt, const std::vector<Pressed>& pressed,
                       const std::string& motion) {
  const Pressed& deepest = pressed.back();
  const Pressed& largest = *std::ranges::max_element(pressed, {}, &Pressed::force_n);
  const double most = felt.device.translation.max_effort;
  std::string text = fmt::format(
      "What will be felt: {:.2g} N with the hand {:.0f} mm deep where the motion '{}' touches "
      "first, {:.0f} % of the {:.3g} N that {} gives",
      deepest.force_n, 1e3 * deepest.depth_m, motion, 100.0 * deepest.force_n / most, most,
      felt.device.name);
  if (largest.force_n > 1.05 * deepest.force_n)
    text +=
        fmt::format("; at most {:.2g} N, {:.0f} mm deep", largest.force_n, 1e3 * largest.depth_m);
  text += ".";
  const double certified = felt.fitted.design.translation.shown_stiffness,
               of_spring = std::min(certified * deepest.depth_m, most);
  if (deepest.force_n >= 0.9 * of_spring)
    return text + limited(limit_of(felt.fitted, felt.device, certified, deepest.force_n));
  if (felt.scene.contact.rendering == scene::RenderingKind::kModelAlone)
    return text +
           limited(fmt::format("the model alone, whose points push no deeper than {:.2g} mm, in a "
                               "wall's voxels; `rendering: penalty` holds their depths.",
                               1e3 * felt.scene.voxel_size_m / felt.scene.device.position_scale));
  return text +
         limited(fmt::format("the {:.4g} N/m that hold here would give {:.2g} N, but the contact "
                             "itself is as stiff as that only some way in, and a stiffer "
                             "one sooner.",
                             certified, of_spring));
}

}  // namespace

std::string limit_of(const fitting::FittedCoupling& fitted,
                     const coupling::design::DeviceModel& device, double at_hand_n_per_m,
                     double force_n) {
  if (force_n >= 0.999 * device.translation.max_effort)
    return "the device's force.";
  if (at_hand_n_per_m >= 0.999 * device.translation.max_stiffness)
    return fmt::format("{} shows no more than {:.4g} N/m stably.", device.name,
                       device.translation.max_stiffness);
  if (!fitted.designed)
    return "the coupling, which the scene sets by hand.";
  return fitted.design.reasons.empty() ? "" : fitted.design.reasons.front();
}

std::string felt_sentence(const fitting::FittedCoupling& fitted, const scene::Scene& scene,
                          const coupling::design::DeviceModel& device, rendering::BuiltScene& built,
                          const std::string& motion, Search search) {
  if (!fitted.refusal.empty())
    return {};
  const Felt felt{scene, device, built.plan().of_contact_alone, fitted};
  const bool body = built.effect_ground().body.has_value();
  if (body || rendering::is_spring(felt.contact)) {
    const double force = force_n(felt, built, nullptr);
    return force > 0.0 ? (body ? of_grip(felt, force) : of_spring(felt, force)) +
                             told(felt, force, built, nullptr, search)
                       : "";
  }
  for (const auto& [name, path] : scene.motions) {
    if (!motion.empty() && name != motion)
      continue;
    const std::vector<Pressed> pressed = press(built, scene, fitted, device, path);
    if (!pressed.empty())
      return of_pressed(felt, pressed, name) +
             told(felt, pressed.back().force_n, built, &path, search);
  }
  return {};
}

}  // namespace voxtouch::felt
