#pragma once
/// Rows of the virtual tool one by one, as core/contact/constraint_rows.hpp says: what the loops
/// over many have to give to the last bit.
#include "core/contact/constraint_rows.hpp"

namespace voxtouch::test {

/// The row of one hit. False where it gives none. Adds to `faces` where it is that of a wall's
/// face.
bool plain_row(const contact::Hit& hit, bool in_surface, const voxmap::DistanceField& field,
               const contact::RowFrame& frame, contact::ConstraintRow& row, int& faces) noexcept;

void keep_nearest_plainly(std::vector<contact::ConstraintRow>& rows, double tilt) noexcept;

}  // namespace voxtouch::test
