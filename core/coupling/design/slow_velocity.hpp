#pragma once
/// A slow velocity estimate for small movements. It reduces the encoder noise that injected damping
/// displays.
#include "core/coupling/design/axis_verdict.hpp"

namespace voxtouch::coupling::design {

/// Ratio of the margin and of the minimum damping ratios that translation must keep on the slow
/// velocity of `spec` alone. Damping acts on it for movements within the band. It is kLargeSwing,
/// or 1 if the band is wider than encoder quantisation explains.
double slow_ratio(const AxisProblem& translation, const CouplingSpec& spec);

/// Whether all cases keep that ratio at `displayed`; always false for a spring-damper. True if
/// `spec` uses no slow velocity.
bool holds_on_slow_velocity(const AxisProblem& translation, const CouplingSpec& spec,
                            const DisplayedStiffness& displayed);

/// Gives `spec` the slowest velocity that keeps the ratio, with the band of the encoder steps, if
/// their effect on the injected damping is perceptible. If no velocity keeps it, or an encoder step
/// is imperceptible, `spec` is unchanged.
void choose_slow_velocity(const AxisProblem& translation, const DisplayedStiffness& displayed,
                          CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
