#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/contact/equilibrium_step.hpp"

namespace voxtouch::contact {

/// The part of `free` that friction lets happen: sticks where the friction needed is at most
/// `friction` times the sum of all rows' pushes, else slips as little as that leaves (laws.md).
/// `rows` and `spring` are those that gave `free`. Both steps keep to the rows, and so does what
/// lies between. `friction` 0 is bit-identical to `free`. Real-time safe.
EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring,
                              double lever_m, double friction,
                              const EquilibriumStep& free) noexcept;

}  // namespace voxtouch::contact
