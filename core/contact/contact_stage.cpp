#include "core/contact/contact_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/limits.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch::contact {

/// Intermediate values of one call of `apply`.
struct ContactStage::Frame {
  double moved_m = 0.0;  ///< bound on the path of every point since the last pose
  /// Force direction of surface points: mean_weight 1 is the mean normal, 0 each point's own.
  ForceDirection direction;
  std::uint32_t common_points = 0;  ///< number of points with force along g in this frame
  StiffnessSum stiffness;           ///< of the points that the model has not summed
  CommonDirectionSum common;        ///< of those with force along g
};

ContactStage::ContactStage(const StageConfig& config) : config_(config) {
  if (!has_memory())
    return;
  last_surface_.reserve(config.points);
  for (std::vector<LatchedHit>* const list : {&latched_, &returning_, &inside_})
    list->reserve(config.points);
}

void ContactStage::reset() noexcept {
  last_surface_.clear();
  latched_.clear();
  has_last_pose_ = false;
  common_.setZero();
  common_points_ = 0;
}

void ContactStage::merge_memory(const ContactStage& other) noexcept {
  if (last_surface_.empty())
    last_direction_ = other.last_direction_;
  last_surface_.merge(other.last_surface_);
  merge_ascending(other.latched_, latched_, [](const LatchedHit& a, const LatchedHit& b) noexcept {
    return a.point < b.point;
  });
  if (common_.isZero(0.0))
    common_ = other.common_;
  common_points_ = std::max(common_points_, other.common_points_);
}

void ContactStage::copy_memory(const ContactStage& other) noexcept {
  last_surface_ = other.last_surface_;
  last_direction_ = other.last_direction_;
  latched_ = other.latched_;
  common_ = other.common_;
  common_points_ = other.common_points_;
}

StageResult ContactStage::apply(const HitList& hits, const ContactResult& plain,
                                double moved_m) noexcept {
  StageResult result;
  result.contact = plain;
  if (hits.pose_status != PoseStatus::kUsable)
    return result;

  Frame frame;
  frame.moved_m = moved_m;
  result.fast = frame.moved_m > limits::kFastEdges * config_.edge_m;
  if (!has_memory()) {
    // Nothing to blend or latch: the depths of `field` reach into interior voxels, and a memoryless
    // model has no force there.
  } else if (hits.surface.empty() && hits.interior.empty()) {
    common_.setZero();
    last_surface_.clear();
    latched_.clear();
  } else {
    update_common_direction(hits);
    frame.direction = {plain.mean_normal, mean_weight(config_.model, plain.coherence)};
    surface_points(hits, frame, result);
    latched_points(hits, frame, result);
    if (frame.stiffness.any())
      frame.stiffness.add_to(config_.stiffness, result.contact.stiffness);
    if (frame.common.any())
      result.contact.stiffness += frame.common.matrix(config_.stiffness, common_now_);
    latched_.resize(returning_.size() + inside_.size());
    std::merge(returning_.begin(), returning_.end(), inside_.begin(), inside_.end(),
               latched_.begin(),
               [](const LatchedHit& a, const LatchedHit& b) { return a.point < b.point; });
    last_surface_ = hits.surface;
    last_direction_ = frame.direction;
  }
  common_points_ = frame.common_points;
  last_pose_ = hits.pose_WT;
  has_last_pose_ = true;
  return result;
}

/// |x1 - x0| <= |t1 - t0| + |(R1 - R0) p| <= |t1 - t0| + 2 sin(angle / 2) |p|, for every p of the
/// shell.
double ContactStage::motion_bound(const Pose& pose) const noexcept {
  const double half_sine = (last_pose_.orientation.conjugate() * pose.orientation).vec().norm();
  return (pose.position - last_pose_.position).norm() + 2.0 * half_sine * config_.reach_m;
}

/// Updates g, the common direction of the latched forces (laws.md).
void ContactStage::update_common_direction(const HitList& hits) noexcept {
  // Includes the points in interior voxels: the rim alone has few points, and its mean reverses
  // beyond the tool's equator.
  Vec3 mean = hits.surface.normal_sum() + hits.interior.normal_sum();
  const double weights = hits.surface.weight_sum() + hits.interior.weight_sum();
  const double length = mean.norm();
  const double coherence = weights > 0.0 ? length / weights : 0.0;
  double fraction = hits.surface.weight_sum() > 0.0
                        ? smoothstep(limits::kBlendFrom, limits::kBlendTo, coherence)
                        : 0.0;
  if (fraction > 0.0)
    mean /= length;
  // While points depend on g, it may be rotated but not reversed.
  if (common_points_ > 0)
    fraction *= smoothstep(limits::kAgreeFrom, limits::kAgreeTo, mean.dot(common_));
  if (fraction >= 1.0)
    common_ = mean;
  common_now_ = common_;
  // In between, only the direction of this frame is mixed: `common_` itself must not drift while
  // the tool rests. The two are less than 90 degrees apart here, so their mix cannot vanish.
  if (fraction > 0.0 && fraction < 1.0 && common_points_ > 0)
    common_now_ = (fraction * mean + (1.0 - fraction) * common_).normalized();
}

/// Depth of a surface point along its force direction [m].
double ContactStage::surface_depth(const Hit& hit, const ForceDirection& direction) const noexcept {
  const double fraction = direction.mean_weight;
  Vec3 along = fraction >= 1.0 ? direction.mean : hit.normal;
  if (fraction > 0.0 && fraction < 1.0) {
    const Vec3 mix = fraction * direction.mean + (1.0 - fraction) * hit.normal;
    along = mix * (1.0 / std::max(mix.norm(), limits::kShortestDirection));
  }
  return std::max(0.0, along.dot(hit.to_centre));
}

Vec3 ContactStage::latched_direction(Direction direction, const Hit& hit) const noexcept {
  return direction == Direction::kCommon ? common_now_ : hit.normal;
}

/// Selects the force direction of a point that has just passed through.
ContactStage::Direction ContactStage::choose_direction(const HitList& hits,
                                                       const Hit& hit) const noexcept {
  if (common_.isZero(0.0))
    return Direction::kOwnNormal;
  const Vec3 arm_before = last_pose_.orientation * (hits.pose_WT.orientation.conjugate() * hit.arm);
  const Vec3 displacement = (hits.pose_WT.position - last_pose_.position) + (hit.arm - arm_before);
  const bool common_opposes = common_.dot(displacement) < 0.0;
  const bool own_opposes = hit.normal.dot(displacement) < 0.0;
  if (config_.model == ContactModelKind::kOriginal)
    return own_opposes || !common_opposes ? Direction::kOwnNormal : Direction::kCommon;
  return hit.normal.dot(common_) >= 0.0 || common_opposes ? Direction::kCommon
                                                          : Direction::kOwnNormal;
}

void ContactStage::add_force(const HitList& hits, const Hit& hit, double depth,
                             const Vec3& direction, ContactResult& result) const noexcept {
  const Vec3 force = (config_.stiffness * (hit.weight * depth)) * direction;
  result.wrench.force += force;
  result.wrench.torque += hit.arm.cross(force);
  if (depth > result.deepest_depth_m) {
    result.deepest_depth_m = depth;
    result.deepest_point = hits.pose_WT.position + hit.arm;
  }
}

void ContactStage::add_stiffness(Direction direction, const Hit& hit, Frame& frame,
                                 ContactResult& result) const noexcept {
  result.stiffness_bound_n_per_m += config_.stiffness * hit.weight;
  if (direction == Direction::kCommon) {
    frame.common.add(hit.arm, hit.weight);
  } else {
    frame.stiffness.add(hit.arm, hit.normal, hit.weight);
  }
}

/// Recomputes the forces of the surface layer if their directions are between own and mean normal;
/// the model's result holds for both ends.
void ContactStage::surface_points(const HitList& hits, Frame& frame,
                                  StageResult& result) const noexcept {
  const bool blended = frame.direction.mean_weight > 0.0 && frame.direction.mean_weight < 1.0;
  ContactResult& contact = result.contact;
  if (blended) {
    contact.wrench = {};
    contact.deepest_depth_m = 0.0;
    contact.deepest_point.setZero();
    contact.stiffness_bound_n_per_m = 0.0;
    contact.stiffness.setZero();
    add_forces_along_directions(hits.surface, frame.direction, config_.stiffness,
                                hits.pose_WT.position, contact, frame.stiffness);
  }
}

/// Handles a point that was latched in the last frame and is in the surface layer again. Its
/// latched depth decreases with the path of the tool, so the force ends without a step. The model
/// has already applied the force of the point's present depth.
void ContactStage::returning_point(const HitList& hits, const Hit& hit, const LatchedHit& before,
                                   Frame& frame, StageResult& result) noexcept {
  const double depth = surface_depth(hit, frame.direction);
  const double latched = before.depth_m - limits::kFadePerMetre * frame.moved_m;
  if (!(latched > depth))
    return;
  add_force(hits, hit, latched - depth, latched_direction(before.direction, hit), result.contact);
  if (!(depth > 0.0))
    add_stiffness(before.direction, hit, frame, result.contact);
  frame.common_points += before.direction == Direction::kCommon;
  result.latched = true;
  returning_.push_back({hit.point, before.direction, latched});
}

/// Depth and force direction of a point that has just passed through.
ContactStage::LatchedHit ContactStage::latch(const HitList& hits, const Hit& hit) const noexcept {
  if (const std::size_t n = last_surface_.find(hit.point); n < last_surface_.size())
    return {hit.point, choose_direction(hits, hit),
            surface_depth(last_surface_[n], last_direction_)};
  return {hit.point, Direction::kOwnNormal, limits::kUnseenDepthEdges * config_.edge_m};
}

/// Handles the points in interior voxels, and latched points that are in the surface layer again.
void ContactStage::latched_points(const HitList& hits, Frame& frame, StageResult& result) noexcept {
  inside_.clear(), returning_.clear();
  std::size_t next = 0, back = 0;  // in latched_ and in the surface hits, which are both ascending
  // Handles the latched points below `point` that are no longer in interior voxels.
  const auto handle_returning = [&](std::uint32_t point) {
    for (; next < latched_.size() && latched_[next].point < point; ++next) {
      const LatchedHit& before = latched_[next];
      back = hits.surface.not_below(before.point, back);
      if (back < hits.surface.size() && hits.surface.point(back) == before.point)
        returning_point(hits, hits.surface[back], before, frame, result);
    }
  };
  if (!hits.interior.empty()) {
    const PenaltyKernel& kernel = penalty_kernel(instructions());
    PenaltyLanes lanes;
    HitBlock block;
    PenaltyForces forces;
    for (std::size_t begin = 0; begin < hits.interior.size(); begin += HitBlock::kHits) {
      fill_block(kernel, hits.interior, begin, block);
      for (std::size_t n = 0; n < block.count; ++n) {
        const std::uint32_t point = hits.interior.point(begin + n);
        handle_returning(point);
        const bool known = next < latched_.size() && latched_[next].point == point;
        LatchedHit latched = known ? latched_[next++] : latch(hits, hits.interior[begin + n]);
        latched.depth_m =
            std::max(latched.depth_m, limits::kLatchedDepthFloorEdges * config_.edge_m);
        inside_.push_back(latched);
        frame.common_points += latched.direction == Direction::kCommon;
      }
      add_latched_forces(block, begin, forces, lanes);
      kernel.add(block, forces, lanes);
    }
    add_lanes(hits.interior, lanes, config_.stiffness, hits.pose_WT.position, result.contact,
              frame.stiffness);
    result.latched = true;
  }
  handle_returning(std::numeric_limits<std::uint32_t>::max());
}

/// Forces of the points of a block; their depths and directions are in inside_, from `first` on.
void ContactStage::add_latched_forces(const HitBlock& block, std::size_t first,
                                      PenaltyForces& forces, PenaltyLanes& lanes) const noexcept {
  forces.add_all(block);
  for (std::size_t n = 0; n < block.filled(); ++n) {
    const LatchedHit& latched = inside_[first + (n < block.count ? n : 0)];
    const bool common = latched.direction == Direction::kCommon;
    for (int axis = 0; axis < 3; ++axis)
      forces.j[axis][n] = common ? common_now_[axis] : block.normal[axis][n];
    forces.force[n] = block.weight[n] * latched.depth_m;
    forces.weight[n] = block.weight[n];
    const std::size_t lane = n % kLanes;
    if (latched.depth_m > lanes.deepest[lane])
      lanes.deepest[lane] = latched.depth_m,
      lanes.deepest_hit[lane] = static_cast<double>(first + n - lane);
  }
}

}  // namespace voxtouch::contact
