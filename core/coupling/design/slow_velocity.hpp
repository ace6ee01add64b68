#pragma once
/// The slower velocity that small movements are damped on, so that less of the encoder's steps is
/// displayed.
#include "core/coupling/design/axis_verdict.hpp"

namespace voxtouch::coupling::design {

/// What translation keeps of the margin, and of the floors of its cases, while damping acts on the
/// slow velocity of `spec` alone, as it does in movements that stay within the band: kLargeSwing,
/// and all where the band is wider than the encoder's steps explain.
double slow_ratio(const AxisProblem& translation, const CouplingSpec& spec);

/// Whether that holds for `displayed` in all cases; never for a spring-damper. True where `spec`
/// damps on no slow velocity.
bool holds_on_slow_velocity(const AxisProblem& translation, const CouplingSpec& spec,
                            const DisplayedStiffness& displayed);

/// Gives `spec` the slowest velocity for which it holds, and the band of the encoder's steps, if
/// what these make of injected damping may be perceived. Where none holds, or a step of the encoder
/// is not perceived, `spec` stays as it is.
void choose_slow_velocity(const AxisProblem& translation, const DisplayedStiffness& displayed,
                          CouplingSpec& spec);

}  // namespace voxtouch::coupling::design
