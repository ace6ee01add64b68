#include "core/contact/push_sums.hpp"

#include <algorithm>

namespace voxtouch::contact {
namespace {

/// Of a list that was written by hand.
void copy_given(const Hit* given, std::size_t begin, std::size_t end, HitBlock& block) noexcept {
  block.count = std::min(HitBlock::kHits, end - begin);
  for (std::size_t n = 0; n < block.filled(); ++n) {
    const Hit& hit = given[begin + (n < block.count ? n : 0)];
    for (int row = 0; row < 3; ++row)
      block.arm[row][n] = hit.arm[row], block.normal[row][n] = hit.normal[row], block.to_centre[row][n] = hit.to_centre[row];
    block.weight[n] = n < block.count ? hit.weight : 0.0;
  }
}

/// The deepest of all lanes, where it is deeper than the result's so far.
void tell_deepest(const Hits& hits, const double (&deepest)[kLanes], const double (&deepest_hit)[kLanes], const Vec3& tool,
                  ContactResult& result) noexcept {
  std::size_t best = kLanes;
  const auto place = [&](std::size_t lane) { return deepest_hit[lane] + static_cast<double>(lane); };
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (!(deepest[lane] > result.deepest_depth_m)) continue;
    if (best == kLanes || deepest[lane] > deepest[best] || (deepest[lane] == deepest[best] && place(lane) < place(best))) best = lane;
  }
  if (best == kLanes) return;
  result.deepest_depth_m = deepest[best];
  result.deepest_point = tool + hits[static_cast<std::size_t>(place(best))].arm;
}

}  // namespace

void fill_block(const PushKernel& kernel, const Hits& hits, std::size_t begin, HitBlock& block) noexcept {
  if (hits.given() != nullptr)
    copy_given(hits.given(), begin, hits.size(), block);
  else
    kernel.fill(hits, begin, hits.size(), block);
}

void add_lanes(const Hits& hits, const PushLanes& lanes, double stiffness, const Vec3& tool, ContactResult& result,
               StiffnessSum& sum) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.wrench.force[static_cast<Eigen::Index>(axis)] += stiffness * combined(lanes.push[axis]);
    result.wrench.torque[static_cast<Eigen::Index>(axis)] += stiffness * combined(lanes.push[axis + 3]);
  }
  result.stiffness_bound_n_per_m += stiffness * combined(lanes.weight);
  for (std::size_t n = 0; n < 21; ++n) sum.entries()[n] += combined(lanes.stiffness[n]);
  tell_deepest(hits, lanes.deepest, lanes.deepest_hit, tool, result);
}

void push_along_directions(const Hits& hits, const PushDirection& direction, double stiffness, const Vec3& tool, ContactResult& result,
                           StiffnessSum& sum) noexcept {
  if (hits.empty()) return;
  const PushKernel& kernel = push_kernel(instructions());
  PushLanes lanes;
  HitBlock block;
  Pushes pushes;
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    fill_block(kernel, hits, begin, block);
    kernel.push(block, direction, begin, pushes, lanes);
    kernel.add(block, pushes, lanes);
  }
  add_lanes(hits, lanes, stiffness, tool, result, sum);
}

void push_along_mean(const Hits& hits, const Vec3& mean, double stiffness, const Vec3& tool, ContactResult& result) noexcept {
  if (hits.empty()) return;
  const PushKernel& kernel = push_kernel(instructions());
  MeanLanes lanes;
  HitBlock block;
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    if (hits.given() != nullptr)
      copy_given(hits.given(), begin, hits.size(), block);
    else
      kernel.fill_places(hits, begin, hits.size(), block);
    kernel.push_along_mean(block, mean, begin, lanes);
  }
  double moments[CommonDirectionSum::kSums];
  for (std::size_t n = 0; n < CommonDirectionSum::kSums; ++n) moments[n] = combined(lanes.moments[n]);
  result.stiffness_bound_n_per_m += stiffness * moments[0];
  result.wrench.force = (stiffness * combined(lanes.push[0])) * mean;
  result.wrench.torque = Vec3(combined(lanes.push[1]), combined(lanes.push[2]), combined(lanes.push[3])).cross(stiffness * mean);
  result.stiffness = CommonDirectionSum(moments).matrix(stiffness, mean);
  tell_deepest(hits, lanes.deepest, lanes.deepest_hit, tool, result);
}

void begin_result(const HitList& hits, ContactResult& result) noexcept {
  result = {};
  result.surface_hits = static_cast<std::uint32_t>(hits.surface.size());
  result.interior_hits = static_cast<std::uint32_t>(hits.interior.size());
  result.points_tested = hits.tested;
  result.left_out = hits.left_out;
  result.pose_status = hits.pose_status;
}

void tell_mean_normal(const Vec3& normals, double weights, ContactResult& result) noexcept {
  const double length = normals.norm();
  if (weights > 0.0) result.coherence = length / weights;
  if (length > 0.0) result.mean_normal = normals / length;
}

}  // namespace voxtouch::contact
