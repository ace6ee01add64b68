#pragma once
/// Coulomb friction on the motion of the virtual tool.
#include <span>

#include "core/contact/equilibrium_step.hpp"

namespace voxtouch::contact {

/// The part of `free` that friction lets happen. `rows` and `spring` are those that gave it.
///
/// The contact slips by the shift of its centre of push across the mean normal m, and by radius
/// times the turn about m: three numbers, kept in place by a friction whose size they share (an
/// ellipsoid as limit surface: Howe and Cutkosky 1996). Two steps are compared: `free`, and one
/// that does not slip, whose tool only goes along m and turns across it as it does in `free`; it
/// needs a friction f. Where |f| is at most mu N the tool sticks: the tool itself is the anchor,
/// and nothing creeps. Else the step lies between both, as far from sticking as leaves a friction
/// of mu N. N is the sum of all rows' pushes, so that a wedge holds as much as its two faces do;
/// radius the mean distance of the pushes from their centre (2/3 of a disc's, as for even
/// pressure), so that turns about m are resisted by mu N radius.
///
/// Friction turns the tool about m only: a ball slides, it does not roll. Both steps keep to the
/// rows, and so does what lies between. `friction` 0 gives `free` to the bit. Real-time safe.
EquilibriumStep with_friction(std::span<const ConstraintRow> rows, const Vec6& spring,
                              double lever_m, double friction,
                              const EquilibriumStep& free) noexcept;

}  // namespace voxtouch::contact
