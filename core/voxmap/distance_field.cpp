#include "core/voxmap/distance_field.hpp"

#include <algorithm>

#include "core/voxmap/interpolation.hpp"
#include "core/voxmap/smooth_block.hpp"

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

/// The nodes of a brick or, without stored nodes, their common cut-off value.
struct DistanceField::Nodes {
  const float* stored;
  double all;
  double operator[](std::int64_t n) const noexcept { return stored != nullptr ? stored[n] : all; }
};

DistanceField::Nodes DistanceField::nodes_of(
    const std::array<std::int64_t, 3>& cell) const noexcept {
  const std::int32_t entry = entry_at(cell[0], cell[1], cell[2]);
  return {entry >= 0 ? bricks_[static_cast<std::size_t>(entry)].data() : nullptr,
          entry == kDeep ? -depth_voxels_ : band_voxels_};
}

/// The corners of the point's voxel are in one brick. The nodes beyond them on one axis are in that
/// brick or the next one on this axis.
void DistanceField::put_smooth(const Vec3& u, std::size_t lane, SmoothBlock& block) const noexcept {
  constexpr std::int64_t kStride[3] = {1, kNodeEdge, kNodeEdge * kNodeEdge};
  constexpr std::size_t kPlace[3] = {1, 4, 16};
  const VoxelIndex voxel = Grid::voxel_of(u);
  const std::int64_t at[3] = {std::int64_t{voxel.i} - base_.i, std::int64_t{voxel.j} - base_.j,
                              std::int64_t{voxel.k} - base_.k};
  block.t[0][lane] = u.x() - voxel.i, block.t[1][lane] = u.y() - voxel.j,
  block.t[2][lane] = u.z() - voxel.k;
  const std::array<std::int64_t, 3> cell = {at[0] >> 3, at[1] >> 3, at[2] >> 3};
  const std::int64_t in[3] = {at[0] & 7, at[1] & 7, at[2] & 7},
                     first = in[0] + kStride[1] * in[1] + kStride[2] * in[2];
  const Nodes own = nodes_of(cell);
  for (std::int64_t k = 0; k < 8; ++k)
    block.node[21 + (k & 1) + 4 * (k >> 1 & 1) + 16 * (k >> 2)][lane] =
        own[first + (k & 1) + kStride[1] * (k >> 1 & 1) + kStride[2] * (k >> 2)];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t second = (axis + 1) % 3, third = (axis + 2) % 3;
    const auto put = [&](const Nodes& nodes, std::int64_t from, std::size_t to) noexcept {
      for (std::size_t k = 0; k < 4; ++k)
        block.node[to + kPlace[second] * (1 + (k & 1)) + kPlace[third] * (1 + (k >> 1))][lane] =
            nodes[from + kStride[second] * static_cast<std::int64_t>(k & 1) +
                  kStride[third] * static_cast<std::int64_t>(k >> 1)];
    };
    std::array<std::int64_t, 3> next = cell;
    if (in[axis] == 0) {
      --next[axis];
      put(nodes_of(next), first + (kBrickEdge - 1) * kStride[axis], 0);
    } else {
      put(own, first - kStride[axis], 0);
    }
    next = cell;
    if (in[axis] == kBrickEdge - 1) {
      ++next[axis];
      put(nodes_of(next), first - (kBrickEdge - 2) * kStride[axis], 3 * kPlace[axis]);
    } else {
      put(own, first + 2 * kStride[axis], 3 * kPlace[axis]);
    }
  }
}

void DistanceField::smooth_gradients(std::size_t count, const Vec3* u,
                                     Vec3* gradients) const noexcept {
  SmoothBlock block;
  if (count < kSmoothTogether)
    block = {};
  for (std::size_t n = 0; n < count; ++n)
    put_smooth(u[n], n, block);
  find_smooth(block, band_voxels_);
  for (std::size_t n = 0; n < count; ++n)
    gradients[n] = {block.gradient[0][n], block.gradient[1][n], block.gradient[2][n]};
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
