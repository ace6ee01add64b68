#pragma once
/// A plane through the voxels of a scene, for people: what the contact models ask is seen, and not
/// only the mesh that it was made from.
#include <cstdint>

#include <nlohmann/json_fwd.hpp>

#include "core/rendering/object_contacts.hpp"

namespace voxtouch::view {

/// A plane across one axis of W.
struct SliceQuestion {
  int axis = 2;               ///< 0, 1, 2: across x, y, z
  double at_m = 0.0;          ///< where it meets that axis
  double scene_time_s = 0.0;  ///< where moving objects are
  bool operator==(const SliceQuestion&) const = default;
};

/// {"type": "slice", "axis", "at", "step", "low": [u, v], "columns", "rows", "cells"}: u and v are
/// the two other axes in their order; of the cell in column c and row r `cells[c + columns * r]` is
/// '0' free, '1' surface, '2' interior, looked up at its centre. `step` [m] is the voxel's edge, or
/// a multiple where there would be more than kMaxCellsPerSide cells a side. All objects together; a
/// surface hides an interior. Null where there are no voxels.
nlohmann::json slice_of(const rendering::ObjectContacts& objects, const SliceQuestion& question);
inline constexpr std::int64_t kMaxCellsPerSide = 192;

}  // namespace voxtouch::view
