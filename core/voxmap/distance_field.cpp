#include "core/voxmap/distance_field.hpp"

#include <algorithm>

#include "core/voxmap/interpolation.hpp"

namespace voxtouch::voxmap {

FieldSample DistanceField::at(const Vec3& u) const noexcept {
  FieldSample sample;
  sample.distance_m = grid_.edge * band_voxels_;
  const Vec3 local = u - Vec3(base_.i, base_.j, base_.k);
  std::array<std::int64_t, 3> voxel{};
  Vec3 t;  // within the voxel
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    if (!(local[axis] >= 0.0 && local[axis] < static_cast<double>(cells_[n] * kBrickEdge)))
      return sample;
    voxel[n] = static_cast<std::int64_t>(local[axis]);
    t[axis] = local[axis] - static_cast<double>(voxel[n]);
  }
  const std::int64_t cell =
      (voxel[0] >> 3) + cells_[0] * ((voxel[1] >> 3) + cells_[1] * (voxel[2] >> 3));
  const std::int32_t entry = table_[static_cast<std::size_t>(cell)];
  if (entry < 0) {
    if (entry == kDeep)
      sample.distance_m = -depth_m(), sample.known = sample.saturated = true;
    return sample;
  }
  constexpr std::size_t kY = kNodeEdge, kZ = kNodeEdge * kNodeEdge;
  const float* const node = &bricks_[static_cast<std::size_t>(entry)][static_cast<std::size_t>(
      (voxel[0] & 7) + kNodeEdge * ((voxel[1] & 7) + kNodeEdge * (voxel[2] & 7)))];
  const double d[8] = {node[0],  node[1],      node[kY],      node[kY + 1],
                       node[kZ], node[kZ + 1], node[kZ + kY], node[kZ + kY + 1]};
  const Interpolated at = interpolated(d, t.x(), t.y(), t.z());
  sample.distance_m = grid_.edge * at.value;
  sample.gradient = {at.along_x, at.along_y, at.along_z};
  const double band = band_voxels_, deep = -depth_voxels_;
  const double least = *std::min_element(std::begin(d), std::end(d));
  sample.known = least < band;
  sample.saturated = least <= deep;
  return sample;
}

double DistanceField::node(const VoxelIndex& voxel) const noexcept {
  // In 64 bits: the difference of two int32.
  const std::int64_t x = std::int64_t{voxel.i} - base_.i, y = std::int64_t{voxel.j} - base_.j,
                     z = std::int64_t{voxel.k} - base_.k;
  const std::int32_t entry = entry_at(x >> 3, y >> 3, z >> 3);
  if (entry < 0)
    return entry == kDeep ? -depth_voxels_ : band_voxels_;
  return bricks_[static_cast<std::size_t>(entry)]
                [static_cast<std::size_t>((x & 7) + kNodeEdge * ((y & 7) + kNodeEdge * (z & 7)))];
}

std::int32_t DistanceField::entry_at(std::int64_t x, std::int64_t y,
                                     std::int64_t z) const noexcept {
  if ((x | y | z) < 0 || x >= cells_[0] || y >= cells_[1] || z >= cells_[2])
    return kFree;
  return table_[static_cast<std::size_t>(x + cells_[0] * (y + cells_[1] * z))];
}

std::size_t DistanceField::bytes() const noexcept {
  return table_.size() * sizeof(std::int32_t) + bricks_.size() * sizeof(Brick);
}

}  // namespace voxtouch::voxmap
