#include "core/contact/penalty_sums.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/contact/packed_normals.hpp"

namespace voxtouch::contact {
namespace {

/// The deepest of all lanes, if it is deeper than that of the result so far.
void set_deepest(const Hits& hits, const double (&deepest)[kLanes],
                 const double (&deepest_hit)[kLanes], const Vec3& tool,
                 ContactResult& result) noexcept {
  std::size_t best = kLanes;
  const auto place = [&](std::size_t lane) {
    return deepest_hit[lane] + static_cast<double>(lane);
  };
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    if (!(deepest[lane] > result.deepest_depth_m))
      continue;
    if (best == kLanes || deepest[lane] > deepest[best] ||
        (deepest[lane] == deepest[best] && place(lane) < place(best)))
      best = lane;
  }
  if (best == kLanes)
    return;
  result.deepest_depth_m = deepest[best];
  result.deepest_point = tool + hits[static_cast<std::size_t>(place(best))].arm;
}

/// Adds the group of eight hits at `place`; the last group of the list may be smaller.
void take_group(const Hits& hits, std::size_t place, HitBlock& block) noexcept {
  block.count = kLanes * block.groups + std::min(kLanes, hits.size() - place);
  block.place[block.groups++] = place;
}

/// Prepares the single-precision test for hits that certainly have no force along `direction`.
/// Returns false if it is not possible.
bool make_rough(const HitSource& source, const ForceDirection& direction,
                RoughDirection& rough) noexcept {
  const double own = 1.0 - direction.mean_weight;
  if (!(source.rough.certain > 0.0F) || (own > 0.0 && source.rough.normal == nullptr))
    return false;
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double mean = direction.mean_weight * direction.mean[axis];
    rough.mean[axis] = static_cast<float>(mean);
    size += std::abs(mean);
    for (int column = 0; column < 3; ++column)
      rough.back[axis][column] =
          static_cast<float>(own * packed_normals::kWordStep * source.r[axis][column]);
  }
  rough.own = own > 0.0, rough.common = size > 0.0;
  // The position error of a point is less than half a voxel minus `certain` in each axis. The point
  // is at most 0.87 voxels from the centre, and the normals have the error of their packing. The
  // last term exceeds the sum of about twenty roundings of numbers of that size.
  const double off = 0.5 - static_cast<double>(source.rough.certain);
  rough.most = static_cast<float>((size + 2.0 * own) * off + 0.87 * own * packed_normals::kMaxOff +
                                  1e-5 * (size + own));
  return true;
}

/// Decides when the single-precision test runs: rarely, if it skips nothing.
class RoughTestSchedule {
 public:
  bool is_due() noexcept { return waiting_ == 0 || --waiting_ == 0; }
  void record(bool skipped) noexcept {
    wait_ = skipped ? 0 : std::min(kLongest, 2 * wait_ + 1);
    waiting_ = wait_;
  }

 private:
  static constexpr std::uint32_t kLongest = 15;  ///< [blocks]
  std::uint32_t wait_ = 0, waiting_ = 0;
};

/// Passes the hits to `each` in blocks, without the groups of eight that have no force. Their
/// contribution is zero, so the result stays bit-identical.
template <class Fill, class Each>
void for_blocks_with_force(const Hits& hits, const ForceDirection& direction,
                           const PenaltyKernel& kernel, Fill&& fill, Each&& each) noexcept {
  RoughDirection rough;
  const bool decides = make_rough(hits.source(), direction, rough);
  RoughTestSchedule schedule;
  HitBlock block;
  const auto flush = [&]() noexcept {
    if (block.groups == 0)
      return;
    fill(hits, block);
    each(block);
    block.groups = block.count = 0;
  };
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    const std::size_t groups =
        (std::min(HitBlock::kHits, hits.size() - begin) + kLanes - 1) / kLanes;
    std::uint32_t left = (1U << groups) - 1U;
    if (decides && schedule.is_due()) {
      const std::uint32_t all = left;
      left = kernel.may_have_force(hits, begin, rough);
      schedule.record(left != all);
    }
    for (; left != 0; left &= left - 1) {
      take_group(hits, begin + kLanes * static_cast<std::size_t>(std::countr_zero(left)), block);
      if (block.groups == HitBlock::kGroups)
        flush();
    }
  }
  flush();
}

}  // namespace

void fill_block(const PenaltyKernel& kernel, const Hits& hits, std::size_t begin,
                HitBlock& block) noexcept {
  block.groups = block.count = 0;
  for (std::size_t g = 0; g < HitBlock::kGroups && begin + kLanes * g < hits.size(); ++g)
    take_group(hits, begin + kLanes * g, block);
  kernel.fill(hits, block);
}

void add_lanes(const Hits& hits, const PenaltyLanes& lanes, double stiffness, const Vec3& tool,
               ContactResult& result, StiffnessSum& sum) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.wrench.force[static_cast<Eigen::Index>(axis)] += stiffness * combined(lanes.force[axis]);
    result.wrench.torque[static_cast<Eigen::Index>(axis)] +=
        stiffness * combined(lanes.force[axis + 3]);
  }
  result.stiffness_bound_n_per_m += stiffness * combined(lanes.weight);
  for (std::size_t n = 0; n < 21; ++n)
    sum.entries()[n] += combined(lanes.stiffness[n]);
  set_deepest(hits, lanes.deepest, lanes.deepest_hit, tool, result);
}

void add_forces_along_directions(const Hits& hits, const ForceDirection& direction,
                                 double stiffness, const Vec3& tool, ContactResult& result,
                                 StiffnessSum& sum) noexcept {
  if (hits.empty())
    return;
  const PenaltyKernel& kernel = penalty_kernel(instructions());
  PenaltyLanes lanes;
  PenaltyForces forces;
  for_blocks_with_force(hits, direction, kernel, kernel.fill, [&](const HitBlock& block) noexcept {
    kernel.compute(block, direction, forces, lanes);
    kernel.add(block, forces, lanes);
  });
  add_lanes(hits, lanes, stiffness, tool, result, sum);
}

void add_forces_along_mean(const Hits& hits, const Vec3& mean, double stiffness, const Vec3& tool,
                           ContactResult& result) noexcept {
  if (hits.empty())
    return;
  const PenaltyKernel& kernel = penalty_kernel(instructions());
  MeanLanes lanes;
  for_blocks_with_force(
      hits, {mean, 1.0}, kernel, kernel.fill_places,
      [&](const HitBlock& block) noexcept { kernel.add_forces_along_mean(block, mean, lanes); });
  double moments[CommonDirectionSum::kSums];
  for (std::size_t n = 0; n < CommonDirectionSum::kSums; ++n)
    moments[n] = combined(lanes.moments[n]);
  result.stiffness_bound_n_per_m += stiffness * moments[0];
  result.wrench.force = (stiffness * combined(lanes.force[0])) * mean;
  result.wrench.torque =
      Vec3(combined(lanes.force[1]), combined(lanes.force[2]), combined(lanes.force[3]))
          .cross(stiffness * mean);
  result.stiffness = CommonDirectionSum(moments).matrix(stiffness, mean);
  set_deepest(hits, lanes.deepest, lanes.deepest_hit, tool, result);
}

void begin_result(const HitList& hits, ContactResult& result) noexcept {
  result = {};
  result.surface_hits = static_cast<std::uint32_t>(hits.surface.size());
  result.interior_hits = static_cast<std::uint32_t>(hits.interior.size());
  result.points_tested = hits.tested;
  result.pose_status = hits.pose_status;
}

void set_mean_normal(const Vec3& normals, double weights, ContactResult& result) noexcept {
  const double length = normals.norm();
  if (weights > 0.0)
    result.coherence = length / weights;
  if (length > 0.0)
    result.mean_normal = normals / length;
}

}  // namespace voxtouch::contact
