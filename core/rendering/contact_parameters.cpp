#include "core/rendering/contact_parameters.hpp"

#include <numeric>

namespace voxtouch {
namespace {

double mean_area_m2(const Pointshell& shell) {
  const double area = std::accumulate(shell.area_m2.begin(), shell.area_m2.end(), 0.0);
  return area > 0.0 ? area / static_cast<double>(shell.size()) : 1.0;
}

PointWeights weights_of(const ContactSpec& spec, ContactModelKind kind) {
  const bool either = kind == ContactModelKind::kOriginal || kind == ContactModelKind::kAdapted;
  return either && !(spec.stiffness_n_per_m3 > 0.0) ? PointWeights::kOne : PointWeights::kArea;
}

}  // namespace

ContactParameters contact_parameters(const ContactSpec& given, ContactModelKind kind, const Pointshell& shell,
                                     std::optional<PointWeights> weights) {
  ContactSpec spec = given;
  if (spec.rendering == RenderingKind::kVirtualTool) spec.stiffness_n_per_m3 = kProbeStiffness;
  const PointWeights chosen = weights.value_or(weights_of(spec, kind));
  const bool by_area = spec.stiffness_n_per_m3 > 0.0;
  if (chosen == PointWeights::kArea)
    return {by_area ? spec.stiffness_n_per_m3 : spec.stiffness_n_per_m / mean_area_m2(shell), chosen};
  return {by_area ? spec.stiffness_n_per_m3 * mean_area_m2(shell) : spec.stiffness_n_per_m, chosen};
}

}  // namespace voxtouch
