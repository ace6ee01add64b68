#include "core/rendering/contact_parameters.hpp"

#include <numeric>

namespace voxtouch::rendering {
namespace {

constexpr double kGravity = 9.81, kFacesOfACube = 6.0;

double area_m2(const pointshell::Pointshell& shell) {
  return std::accumulate(shell.area_m2.begin(), shell.area_m2.end(), 0.0);
}

double mean_area_m2(const pointshell::Pointshell& shell) {
  const double area = area_m2(shell);
  return area > 0.0 ? area / static_cast<double>(shell.size()) : 1.0;
}

contact::PointWeights weights_of(const scene::ContactSpec& spec, contact::ContactModelKind kind) {
  const bool either =
      kind == contact::ContactModelKind::kOriginal || kind == contact::ContactModelKind::kAdapted;
  return either && !(spec.stiffness_n_per_m3 > 0.0) ? contact::PointWeights::kOne
                                                    : contact::PointWeights::kArea;
}

}  // namespace

double body_stiffness_n_per_m3(double mass_kg, double area_m2) noexcept {
  return area_m2 > 0.0 ? mass_kg * kGravity * kFacesOfACube / (scene::kRestDepthM * area_m2) : 0.0;
}

contact::ContactParameters contact_parameters(const scene::ContactSpec& given,
                                              contact::ContactModelKind kind,
                                              const pointshell::Pointshell& shell,
                                              std::optional<contact::PointWeights> weights) {
  scene::ContactSpec spec = given;
  if (spec.rendering == scene::RenderingKind::kVirtualTool)
    spec.stiffness_n_per_m3 = kProbeStiffness;
  else if (spec.body_mass_kg > 0.0)
    spec.stiffness_n_per_m3 = body_stiffness_n_per_m3(spec.body_mass_kg, area_m2(shell));
  const contact::PointWeights chosen = weights.value_or(weights_of(spec, kind));
  const bool by_area = spec.stiffness_n_per_m3 > 0.0,
             memoryless = spec.rendering == scene::RenderingKind::kMemoryless;
  if (chosen == contact::PointWeights::kArea)
    return {by_area ? spec.stiffness_n_per_m3 : spec.stiffness_n_per_m / mean_area_m2(shell),
            chosen, memoryless};
  return {by_area ? spec.stiffness_n_per_m3 * mean_area_m2(shell) : spec.stiffness_n_per_m, chosen,
          memoryless};
}

}  // namespace voxtouch::rendering
