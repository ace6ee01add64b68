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
    if (!(local[axis] >= 0.0 && local[axis] < static_cast<double>(cells_[n] * kBrickEdge))) return sample;
    voxel[n] = static_cast<std::int64_t>(local[axis]);
    t[axis] = local[axis] - static_cast<double>(voxel[n]);
  }
  const std::int64_t cell = (voxel[0] >> 3) + cells_[0] * ((voxel[1] >> 3) + cells_[1] * (voxel[2] >> 3));
  const std::int32_t entry = table_[static_cast<std::size_t>(cell)];
  if (entry < 0) {
    if (entry == kDeep) sample.distance_m = -depth_m(), sample.known = sample.saturated = true;
    return sample;
  }
  constexpr std::size_t kY = kNodeEdge, kZ = kNodeEdge * kNodeEdge;
  const float* const node =
      &bricks_[static_cast<std::size_t>(entry)]
              [static_cast<std::size_t>((voxel[0] & 7) + kNodeEdge * ((voxel[1] & 7) + kNodeEdge * (voxel[2] & 7)))];
  const double d[8] = {node[0], node[1], node[kY], node[kY + 1], node[kZ], node[kZ + 1], node[kZ + kY], node[kZ + kY + 1]};
  const Interpolated at = interpolated(d, t.x(), t.y(), t.z());
  sample.distance_m = grid_.edge * at.value;
  sample.gradient = {at.along_x, at.along_y, at.along_z};
  const double band = band_voxels_, deep = -depth_voxels_;
  const double least = *std::min_element(std::begin(d), std::end(d));
  sample.known = least < band;
  sample.saturated = least <= deep;
  return sample;
}

Vec3 DistanceField::smooth_gradient(const Vec3& u) const noexcept {
  const VoxelIndex voxel = Grid::voxel_of(u);
  const std::int32_t at[3] = {voxel.i, voxel.j, voxel.k};
  const double t[3] = {u.x() - voxel.i, u.y() - voxel.j, u.z() - voxel.k};
  // The 4 x 4 x 4 nodes round the voxel, without those that lie beyond its corners on two axes.
  constexpr std::size_t kStride[3] = {1, 4, 16};
  double nodes[64];
  const std::int64_t low[3] = {std::int64_t{at[0]} - base_.i - 1, std::int64_t{at[1]} - base_.j - 1, std::int64_t{at[2]} - base_.k - 1};
  const bool in_table = (low[0] | low[1] | low[2]) >= 0 && (low[0] >> 3) < cells_[0] && (low[1] >> 3) < cells_[1] && (low[2] >> 3) < cells_[2];
  const std::int32_t entry = in_table ? table_[static_cast<std::size_t>((low[0] >> 3) + cells_[0] * ((low[1] >> 3) + cells_[1] * (low[2] >> 3)))] : kFree;
  const bool in_brick = entry >= 0 && (low[0] & 7) <= kNodeEdge - 4 && (low[1] & 7) <= kNodeEdge - 4 && (low[2] & 7) <= kNodeEdge - 4;
  const float* const first = in_brick ? &bricks_[static_cast<std::size_t>(entry)][static_cast<std::size_t>(
                                            (low[0] & 7) + kNodeEdge * ((low[1] & 7) + kNodeEdge * (low[2] & 7)))] : nullptr;
  const auto beside = [](int i) noexcept { return i == 0 || i == 3; };
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        if (beside(x) + beside(y) + beside(z) < 2)
          nodes[x + 4 * y + 16 * z] = in_brick ? first[x + kNodeEdge * (y + kNodeEdge * z)] : node({at[0] + x - 1, at[1] + y - 1, at[2] + z - 1});
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis), second = (n + 1) % 3, third = (n + 2) % 3;
    const std::size_t along = kStride[n];
    double line[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const double* const d = nodes + kStride[second] * (1 + (k & 1)) + kStride[third] * (1 + (k >> 1));
      const double d1 = d[along], d2 = d[2 * along];
      const double d0 = d[0] >= band_voxels_ ? 2.0 * d1 - d2 : d[0], d3 = d[3 * along] >= band_voxels_ ? 2.0 * d2 - d1 : d[3 * along];
      line[k] = 0.5 * mix(d2 - d0, d3 - d1, t[n]);
    }
    gradient[axis] = mix(mix(line[0], line[1], t[second]), mix(line[2], line[3], t[second]), t[third]);
  }
  return gradient;
}

double DistanceField::node(const VoxelIndex& voxel) const noexcept {
  // In 64 bits: the difference of two int32.
  const std::int64_t x = std::int64_t{voxel.i} - base_.i, y = std::int64_t{voxel.j} - base_.j,
                     z = std::int64_t{voxel.k} - base_.k;
  if ((x | y | z) < 0 || (x >> 3) >= cells_[0] || (y >> 3) >= cells_[1] || (z >> 3) >= cells_[2]) return band_voxels_;
  const std::int32_t entry = table_[static_cast<std::size_t>((x >> 3) + cells_[0] * ((y >> 3) + cells_[1] * (z >> 3)))];
  if (entry < 0) return entry == kDeep ? -depth_voxels_ : band_voxels_;
  return bricks_[static_cast<std::size_t>(entry)]
                [static_cast<std::size_t>((x & 7) + kNodeEdge * ((y & 7) + kNodeEdge * (z & 7)))];
}

std::size_t DistanceField::bytes() const noexcept {
  return table_.size() * sizeof(std::int32_t) + bricks_.size() * sizeof(Brick);
}

}  // namespace voxtouch::voxmap
