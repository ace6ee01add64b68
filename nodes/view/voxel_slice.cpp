#include "nodes/view/voxel_slice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "nodes/view/rounded.hpp"

namespace voxtouch::view {
namespace {

using voxmap::VoxelKind;

Vec3 displacement(const rendering::StaticObject& object, double scene_time_s) {
  return object.moves ? motion_at(*object.moves, scene_time_s).position : Vec3::Zero();
}

/// The voxel at a position in W; free far outside, so that no index overflows.
VoxelKind kind_at(const rendering::StaticObject& object, const Vec3& shift, const Vec3& x) {
  const Vec3 u = object.voxmap.grid().to_grid(x - shift);
  constexpr double kFar = 1 << 30;
  return u.cwiseAbs().maxCoeff() < kFar ? object.voxmap.at(voxmap::Grid::voxel_of(u))
                                        : VoxelKind::kFree;
}

}  // namespace

nlohmann::json slice_of(const rendering::ObjectContacts& objects, const SliceRequest& q) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (std::size_t n = 0; n < objects.size(); ++n) {
    const voxmap::Voxmap& map = objects.object(n).voxmap;
    const Vec3 shift = displacement(objects.object(n), q.scene_time_s),
               base(map.base().i, map.base().j, map.base().k);
    const Vec3 size = voxmap::Voxmap::kBrickEdge * Vec3(static_cast<double>(map.cells()[0]),
                                                        static_cast<double>(map.cells()[1]),
                                                        static_cast<double>(map.cells()[2]));
    low = low.cwiseMin(map.grid().from_grid(base) + shift);
    high = high.cwiseMax(map.grid().from_grid(base + size) + shift);
  }
  if (!(low.array() < high.array()).all())
    return nullptr;
  const int u = q.axis == 0 ? 1 : 0, v = q.axis == 2 ? 1 : 2;
  const double edge = objects.object(0).voxmap.grid().edge;
  // Cells align with the voxels of the first object.
  const double every = std::max(1.0, std::ceil(std::max(high[u] - low[u], high[v] - low[v]) / edge /
                                               static_cast<double>(kMaxCellsPerSide)));
  const double step = every * edge;
  const Vec3 origin = objects.object(0).voxmap.grid().origin;
  const auto snapped = [&](int axis) {
    return origin[axis] + edge * std::floor((low[axis] - origin[axis]) / edge + 1e-9);
  };
  const double low_u = snapped(u), low_v = snapped(v);
  const auto columns = static_cast<std::int64_t>(std::ceil((high[u] - low_u) / step - 1e-9)),
             rows = static_cast<std::int64_t>(std::ceil((high[v] - low_v) / step - 1e-9));
  std::string cells;
  cells.reserve(static_cast<std::size_t>(columns * rows));
  for (std::int64_t r = 0; r < rows; ++r)
    for (std::int64_t c = 0; c < columns; ++c) {
      Vec3 x;
      x[q.axis] = q.at_m, x[u] = low_u + (static_cast<double>(c) + 0.5) * step,
      x[v] = low_v + (static_cast<double>(r) + 0.5) * step;
      VoxelKind seen = VoxelKind::kFree;
      for (std::size_t n = 0; n < objects.size() && seen != VoxelKind::kSurface; ++n)
        if (const VoxelKind kind =
                kind_at(objects.object(n), displacement(objects.object(n), q.scene_time_s), x);
            kind != VoxelKind::kFree)
          seen = kind;
      cells.push_back(static_cast<char>('0' + static_cast<int>(seen)));
    }
  return {{"type", "slice"},        {"axis", std::string(1, "xyz"[q.axis])},
          {"at", rounded(q.at_m)},  {"step", rounded(step)},
          {"voxel", rounded(edge)}, {"low", {rounded(low_u), rounded(low_v)}},
          {"columns", columns},     {"rows", rows},
          {"cells", cells}};
}

}  // namespace voxtouch::view
