#pragma once
/// A plane through the voxels of a scene: shows the data that contact models query.
#include <cstdint>

#include <nlohmann/json_fwd.hpp>

#include "core/rendering/object_contacts.hpp"

namespace voxtouch::view {

/// A plane across one axis of W.
struct SliceRequest {
  int axis = 2;               ///< 0, 1, 2: across x, y, z
  double at_m = 0.0;          ///< position on that axis
  double scene_time_s = 0.0;  ///< time of moving objects
  bool operator==(const SliceRequest&) const = default;
};

/// {"type": "slice", "axis", "at", "step", "low": [u, v], "columns", "rows", "cells"}: u and v are
/// the two other axes in their order. `cells[c + columns * r]` is the voxel at the centre of column
/// c, row r: '0' free, '1' surface, '2' interior. `step` [m] is the voxel edge, or a multiple if a
/// side would exceed kMaxCellsPerSide cells. Objects are merged; surface hides interior. Null
/// without voxels.
nlohmann::json slice_of(const rendering::ObjectContacts& objects, const SliceRequest& request);
inline constexpr std::int64_t kMaxCellsPerSide = 192;

}  // namespace voxtouch::view
