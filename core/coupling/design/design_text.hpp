#pragma once
/// What a person reads of a design: what limits it, and what it would take.
#include <string>
#include <vector>

#include "core/coupling/design/design_axis.hpp"

namespace voxtouch {

/// What limits, one sentence each.
std::vector<std::string> reasons_of(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                                    const Design& design);

/// What would give the wish as it is: device damping, a shorter delay, a cap, a grip. Each was tried by the same certificates,
/// with everything else unchanged. Empty where the wish is met.
std::vector<std::string> remedies_of(const DesignProblem& request, const std::vector<AxisProblem>& problems,
                                     const Design& design);

}  // namespace voxtouch
