#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/contact/equilibrium_step.hpp"

namespace voxtouch::contact {

/// The part of the step `free` that friction allows. The tool sticks if the required friction is at
/// most `friction` times the sum of the row forces, otherwise it slips by the least amount
/// (laws.md). `rows` and `spring` are those of `free`. Both steps satisfy the rows, and so does
/// every step between them. `friction` 0 is bit-identical to `free`. Real-time safe.
EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring,
                              double lever_m, double friction,
                              const EquilibriumStep& free) noexcept;

}  // namespace voxtouch::contact
