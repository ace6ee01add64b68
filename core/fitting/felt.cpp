#include "core/fitting/felt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/fitting/design_problem.hpp"

namespace voxtouch::fitting {

std::string felt_sentence(const FittedCoupling& fitted, const scene::Scene& scene, const coupling::design::DeviceModel& device,
                          const rendering::StiffnessBounds& bounds) {
  constexpr double kDepthM = 0.01, kLittle = 0.2;
  if (!rendering::is_spring(bounds) || !fitted.refusal.empty()) return {};
  const double shown = spring_n_per_m(fitted, scene, device, bounds);
  const double at_hand = stiffness_at_hand_n_per_m(fitted.spec, scene.device, shown);
  const double most = device.translation.max_effort, force = std::min(at_hand * kDepthM, most), share = force / most;
  if (!(at_hand > 0.0)) return {};
  std::string text = fmt::format(
      "What will be felt: {:.4g} N/m at the hand, certified with a margin of {:.3g}: {:.3g} N with the hand 10 mm deep, {:.0f} % of the {:.3g} N "
      "that {} gives, which it reaches {:.3g} mm deep.",
      at_hand, fitted.design.translation.gain_margin, force, 100.0 * share, most, device.name, 1e3 * most / at_hand);
  if (!fitted.designed) return text;
  const double turning = spring_n_per_m(fitted, scene, device, {bounds.translation, {}});
  if (turning > 1.001 * shown)
    text += fmt::format(" Turning limits it: a tool.lever_m of {:.1f} mm or less gives {:.4g} N/m.",
                        1e3 * std::sqrt(shown / turning * bounds.rotation.one_point / bounds.translation.one_point), turning);
  if (!fitted.design.reasons.empty()) text += " What limits it: " + fitted.design.reasons.front();
  const std::size_t changes = std::min<std::size_t>(share < kLittle ? 2 : 1, fitted.design.remedies.size());
  for (std::size_t n = 0; n < changes; ++n) text += (n == 0 ? " More: " : " Or: ") + fitted.design.remedies[n];
  return text;
}

}  // namespace voxtouch::fitting
