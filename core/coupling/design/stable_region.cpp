#include "core/coupling/design/stable_region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/coupling/design/certificates.hpp"
#include "core/coupling/design/design_cases.hpp"

namespace voxtouch::coupling::design {
namespace {

/// The critical stiffness of the worst case for one controller.
double worst_critical_stiffness(const AxisModel& axis, const LoopTiming& timing,
                                const HandRange& hand, const LoopController& controller) {
  double worst = std::numeric_limits<double>::infinity();
  for (const DesignCase& one : design_cases(axis, timing, hand))
    worst = std::min(worst, critical_stiffness(one.plant, controller).stiffness);
  return worst;
}

}  // namespace

StableRegion stable_region(const AxisModel& axis, const LoopTiming& timing, const HandRange& hand,
                           const LoopController& chosen, double low_hz, double high_hz, int count) {
  StableRegion region;
  const double ratio = std::log(high_hz / low_hz) / std::max(1, count - 1);
  for (int i = 0; i < count; ++i) {
    const double cutoff_hz = low_hz * std::exp(ratio * i);
    LoopController controller = chosen;
    controller.law = LoopController::Law::kShapingFilter;
    controller.gain = 1.0;
    controller.w0_rad_per_s = 2.0 * std::numbers::pi * cutoff_hz;
    region.cutoff_hz.push_back(cutoff_hz);
    region.critical.push_back(worst_critical_stiffness(axis, timing, hand, controller));
    controller.injected_damping = 0.0;
    region.critical_undamped.push_back(worst_critical_stiffness(axis, timing, hand, controller));
    region.passive.push_back(passive_stiffness_filter(controller.w0_rad_per_s,
                                                      controller.damping_ratio, axis.damping,
                                                      timing, effort_lag_s(axis)));
  }
  return region;
}

}  // namespace voxtouch::coupling::design
