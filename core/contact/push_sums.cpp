#include "core/contact/push_sums.hpp"

#include <cmath>

#include "core/contact/hit_block.hpp"
#include "core/contact/limits.hpp"

namespace voxtouch::contact {
namespace {

constexpr std::size_t kHits = HitBlock::kHits;

/// sums[k] += columns[k][n], n after n.
template <std::size_t kColumns>
VOXTOUCH_INLINE void add_in_order(const double (&columns)[kColumns][kHits], std::size_t count, double (&sums)[kColumns]) noexcept {
  double now[kColumns];
  for (std::size_t k = 0; k < kColumns; ++k) now[k] = sums[k];
  for (std::size_t n = 0; n < count; ++n)
    for (std::size_t k = 0; k < kColumns; ++k) now[k] += columns[k][n];
  for (std::size_t k = 0; k < kColumns; ++k) sums[k] = now[k];
}

VOXTOUCH_INLINE void note_deepest(const HitBlock& block, const double (&depth)[kHits], std::size_t count, const Vec3& tool,
                                  ContactResult& result) noexcept {
  std::size_t deepest = kHits;
  double most = result.deepest_depth_m;
  for (std::size_t n = 0; n < count; ++n)
    if (depth[n] > most) most = depth[n], deepest = n;
  if (deepest == kHits) return;
  result.deepest_depth_m = most;
  result.deepest_point = tool + Vec3(block.arm[0][deepest], block.arm[1][deepest], block.arm[2][deepest]);
}

/// Columns of one block along own directions: the push itself, then the upper triangle of w J' J by rows in thirds, so that each
/// third's sums stay in registers.
struct Columns {
  alignas(64) double depth[kHits], push[7][kHits], stiffness[3][7][kHits];
};

VOXTOUCH_INLINE void work_out(const HitBlock& block, const PushDirection& direction, double stiffness, Columns& out) noexcept {
  const double s = direction.mean_share, own = 1.0 - s;
  const double sm0 = s * direction.mean[0], sm1 = s * direction.mean[1], sm2 = s * direction.mean[2];
  alignas(64) double j[6][kHits], weight[kHits];
  if (s > 0.0) {
    for (std::size_t n = 0; n < kHits; ++n) {
      const double x = sm0 + own * block.normal[0][n], y = sm1 + own * block.normal[1][n], z = sm2 + own * block.normal[2][n];
      const double norm = std::sqrt(x * x + y * y + z * z);
      const double length = norm > limits::kShortestDirection ? norm : limits::kShortestDirection;
      j[0][n] = x / length, j[1][n] = y / length, j[2][n] = z / length;
    }
  } else {
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t n = 0; n < kHits; ++n) j[row][n] = block.normal[row][n];
  }
  for (std::size_t n = 0; n < kHits; ++n) {
    const double ux = j[0][n], uy = j[1][n], uz = j[2][n];
    const double along = ux * block.to_centre[0][n] + uy * block.to_centre[1][n] + uz * block.to_centre[2][n];
    const double depth = along > 0.0 ? along : 0.0;
    const double push = stiffness * (block.weight[n] * depth);
    const double fx = push * ux, fy = push * uy, fz = push * uz;
    const double ax = block.arm[0][n], ay = block.arm[1][n], az = block.arm[2][n];
    out.depth[n] = depth;
    out.push[0][n] = fx, out.push[1][n] = fy, out.push[2][n] = fz;
    out.push[3][n] = ay * fz - az * fy, out.push[4][n] = az * fx - ax * fz, out.push[5][n] = ax * fy - ay * fx;
    weight[n] = depth > 0.0 ? block.weight[n] : 0.0;
    out.push[6][n] = stiffness * weight[n];
    j[3][n] = ay * uz - az * uy, j[4][n] = az * ux - ax * uz, j[5][n] = ax * uy - ay * ux;
  }
  std::size_t entry = 0;
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = row; column < 6; ++column, ++entry)
      for (std::size_t n = 0; n < kHits; ++n)
        out.stiffness[entry / 7][entry % 7][n] = weight[n] * (j[row][n] * j[column][n]);
}

}  // namespace

VOXTOUCH_CLONES
void push_along_directions(const Hits& hits, std::size_t begin, std::size_t end, const PushDirection& direction, double stiffness,
                           const Vec3& tool, ContactResult& result, StiffnessSum& sum) noexcept {
  if (begin >= end) return;
  double push[7], entries[3][7];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    push[axis] = result.wrench.force[static_cast<Eigen::Index>(axis)];
    push[axis + 3] = result.wrench.torque[static_cast<Eigen::Index>(axis)];
  }
  push[6] = result.stiffness_bound_n_per_m;
  for (std::size_t n = 0; n < 21; ++n) entries[n / 7][n % 7] = sum.entries()[n];
  HitBlock block;
  Columns columns;
  for (; begin < end; begin += kHits) {
    const std::size_t count = fill(hits, begin, end, block);
    work_out(block, direction, stiffness, columns);
    note_deepest(block, columns.depth, count, tool, result);
    add_in_order(columns.push, count, push);
    for (std::size_t third = 0; third < 3; ++third) add_in_order(columns.stiffness[third], count, entries[third]);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.wrench.force[static_cast<Eigen::Index>(axis)] = push[axis];
    result.wrench.torque[static_cast<Eigen::Index>(axis)] = push[axis + 3];
  }
  result.stiffness_bound_n_per_m = push[6];
  for (std::size_t n = 0; n < 21; ++n) sum.entries()[n] = entries[n / 7][n % 7];
}

VOXTOUCH_CLONES
void push_along_mean(const Hits& hits, const Vec3& mean, double stiffness, const Vec3& tool, ContactResult& result) noexcept {
  const double m0 = mean[0], m1 = mean[1], m2 = mean[2];
  double pushed[5] = {}, moments[CommonDirectionSum::kSums] = {};
  pushed[4] = result.stiffness_bound_n_per_m;
  HitBlock block;
  alignas(64) double depth[kHits], push[5][kHits], moment[CommonDirectionSum::kSums][kHits];
  for (std::size_t begin = 0; begin < hits.size(); begin += kHits) {
    const std::size_t count = fill(hits, begin, hits.size(), block);
    for (std::size_t n = 0; n < kHits; ++n) {
      const double along = m0 * block.to_centre[0][n] + m1 * block.to_centre[1][n] + m2 * block.to_centre[2][n];
      depth[n] = along > 0.0 ? along : 0.0;
      const double weighed = block.weight[n] * depth[n], weight = depth[n] > 0.0 ? block.weight[n] : 0.0;
      const double ax = block.arm[0][n], ay = block.arm[1][n], az = block.arm[2][n];
      push[0][n] = weighed, push[1][n] = weighed * ax, push[2][n] = weighed * ay, push[3][n] = weighed * az;
      push[4][n] = stiffness * weight;
      const double wx = weight * ax, wy = weight * ay, wz = weight * az;
      moment[0][n] = weight, moment[1][n] = wx, moment[2][n] = wy, moment[3][n] = wz;
      moment[4][n] = wx * ax, moment[5][n] = wx * ay, moment[6][n] = wx * az;
      moment[7][n] = wy * ay, moment[8][n] = wy * az, moment[9][n] = wz * az;
    }
    note_deepest(block, depth, count, tool, result);
    add_in_order(push, count, pushed);
    add_in_order(moment, count, moments);
  }
  result.stiffness_bound_n_per_m = pushed[4];
  result.wrench.force = (stiffness * pushed[0]) * mean;
  result.wrench.torque = Vec3(pushed[1], pushed[2], pushed[3]).cross(stiffness * mean);
  result.stiffness = CommonDirectionSum(moments).matrix(stiffness, mean);
}

VOXTOUCH_CLONES
void add_normals(const Hits& hits, Vec3& normals, double& weights) noexcept {
  if (hits.empty()) return;
  double sums[4] = {normals[0], normals[1], normals[2], weights};
  HitBlock block;
  alignas(64) double weighed[4][kHits];
  for (std::size_t begin = 0; begin < hits.size(); begin += kHits) {
    const std::size_t count = fill_only_normals(hits, begin, hits.size(), block);
    for (std::size_t n = 0; n < kHits; ++n) {
      for (std::size_t row = 0; row < 3; ++row) weighed[row][n] = block.weight[n] * block.normal[row][n];
      weighed[3][n] = block.weight[n];
    }
    add_in_order(weighed, count, sums);
  }
  normals = {sums[0], sums[1], sums[2]};
  weights = sums[3];
}

void begin_result(const HitList& hits, ContactResult& result) noexcept {
  result = {};
  result.surface_hits = static_cast<std::uint32_t>(hits.surface.size());
  result.interior_hits = static_cast<std::uint32_t>(hits.interior.size());
  result.points_tested = hits.tested;
  result.pose_status = hits.pose_status;
}

void tell_mean_normal(const Vec3& normals, double weights, ContactResult& result) noexcept {
  const double length = normals.norm();
  if (weights > 0.0) result.coherence = length / weights;
  if (length > 0.0) result.mean_normal = normals / length;
}

}  // namespace voxtouch::contact
