#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/contact/equilibrium_step.hpp"

namespace voxtouch {

/// The part of `free` that friction lets happen. `rows` and `spring` are those that gave it.
///
/// The contact slips by y = [shift of its centre of push across the mean normal m; radius * turn about m], three numbers. Two
/// steps are solved: `free`, and one that sticks (y = 0), which needs a friction wrench f. Where |f| is at most mu N the tool
/// sticks: the tool itself is the anchor, and nothing creeps. Else the step lies between both, as far from sticking as leaves a
/// friction of mu N. N is the sum of all rows' pushes, so that a wedge holds as much as its two faces do; radius the mean
/// distance of the pushes from their centre (2/3 of a disc's, as for even pressure), so that turns about m are held by mu N radius.
/// Energy is only lost: the energy is convex along the way from sticking to free and least at its end.
/// No slip without a push; `friction` 0 gives `free` to the bit. Real-time safe.
EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring, double lever_m, double friction,
                              const EquilibriumStep& free) noexcept;

}  // namespace voxtouch
