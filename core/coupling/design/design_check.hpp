#pragma once
/// Requests that nothing can be designed for.
#include "core/coupling/design/designer.hpp"

namespace voxtouch {

/// Throws std::invalid_argument with the first sentence about what is wrong with device, hands, contact or wishes.
void refuse_impossible(const DesignProblem& request);

}  // namespace voxtouch
