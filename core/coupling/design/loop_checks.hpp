#pragma once
/// What a loop must be before anything is computed of it. For this folder's own functions.
#include "core/coupling/design/loop_parts.hpp"
#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// Each throws std::invalid_argument with a sentence that names field, value and rule.
void require_finite(const char* field, double value);
void require_not_negative(const char* field, double value);  ///< and finite
void require_positive(const char* field, double value);      ///< and finite
void require_loop(const LoopPlant& plant);
void require_loop(const LoopController& controller);

}  // namespace voxtouch::coupling::design
