#include "core/scene/contact_parameters.hpp"

#include <numeric>

namespace voxtouch {

ContactParameters contact_parameters(const ContactSpec& spec, ContactModelKind kind, const Pointshell& shell) {
  if (spec.stiffness_n_per_m3 > 0.0) return {spec.stiffness_n_per_m3, PointWeights::kArea};
  if (kind == ContactModelKind::kOriginal || kind == ContactModelKind::kAdapted)
    return {spec.stiffness_n_per_m, PointWeights::kOne};
  const double area = std::accumulate(shell.area_m2.begin(), shell.area_m2.end(), 0.0);
  const double mean = area > 0.0 ? area / static_cast<double>(shell.size()) : 1.0;
  return {spec.stiffness_n_per_m / mean, PointWeights::kArea};
}

}  // namespace voxtouch
