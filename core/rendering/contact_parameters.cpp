#include "core/rendering/contact_parameters.hpp"

#include <numeric>

namespace voxtouch::rendering {
namespace {

double mean_area_m2(const pointshell::Pointshell& shell) {
  const double area = std::accumulate(shell.area_m2.begin(), shell.area_m2.end(), 0.0);
  return area > 0.0 ? area / static_cast<double>(shell.size()) : 1.0;
}

contact::PointWeights weights_of(const scene::ContactSpec& spec, contact::ContactModelKind kind) {
  const bool either =
      kind == contact::ContactModelKind::kOriginal || kind == contact::ContactModelKind::kAdapted;
  return either && !(spec.stiffness_n_per_m3 > 0.0) ? contact::PointWeights::kOne
                                                    : contact::PointWeights::kArea;
}

}  // namespace

contact::ContactParameters contact_parameters(const scene::ContactSpec& given,
                                              contact::ContactModelKind kind,
                                              const pointshell::Pointshell& shell,
                                              std::optional<contact::PointWeights> weights) {
  scene::ContactSpec spec = given;
  if (spec.rendering == scene::RenderingKind::kVirtualTool)
    spec.stiffness_n_per_m3 = kProbeStiffness;
  const contact::PointWeights chosen = weights.value_or(weights_of(spec, kind));
  const bool by_area = spec.stiffness_n_per_m3 > 0.0,
             alone = spec.rendering == scene::RenderingKind::kModelAlone;
  if (chosen == contact::PointWeights::kArea)
    return {by_area ? spec.stiffness_n_per_m3 : spec.stiffness_n_per_m / mean_area_m2(shell),
            chosen, alone};
  return {by_area ? spec.stiffness_n_per_m3 * mean_area_m2(shell) : spec.stiffness_n_per_m, chosen,
          alone};
}

}  // namespace voxtouch::rendering
