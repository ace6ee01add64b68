#include "core/contact/contact_stage.hpp"

#include <algorithm>
#include <cmath>

#include "core/contact/limits.hpp"
#include "core/contact/stiffness_sum.hpp"
#include "core/types/smoothstep.hpp"

namespace voxtouch {

namespace limits = contact_limits;

/// What one call of `apply` carries along.
struct ContactStage::Frame {
  double moved_m = 0.0;             ///< bound on every point's way since the last pose
  double mean_share = 0.0;          ///< s of the surface law: 0 own normals, 1 mean normal
  Vec3 mean = Vec3::Zero();
  std::uint32_t shared_points = 0;  ///< that push along g in this frame
  StiffnessSum stiffness;           ///< of the points that the model has not summed ...
  CommonDirectionSum shared;        ///< ... and of those that push along g
};

ContactStage::ContactStage(const StageConfig& config)
    : config_(config), memory_(remembers(config.model) ? config.points : 0) {}

void ContactStage::reset() noexcept {
  ++frame_;  // makes every point's memory stale ...
  ++frame_;  // ... also that of the frame before
  has_last_pose_ = false;
  shared_.setZero();
  shared_points_ = 0;
}

StageResult ContactStage::apply(const HitList& hits, const ContactResult& plain, double moved_m) noexcept {
  StageResult result;
  result.contact = plain;
  if (hits.pose_status != PoseStatus::kUsable) return result;

  Frame frame;
  frame.moved_m = moved_m;
  result.fast = frame.moved_m > limits::kFastEdges * config_.edge_m;
  ++frame_;
  if (!remembers(config_.model)) {
    // Nothing to blend, and nothing to hold: their depths reach into interior voxels.
  } else if (hits.surface.empty() && hits.interior.empty()) {
    shared_.setZero();
  } else {
    update_shared_direction(hits);
    frame.mean = plain.mean_normal;
    if (config_.model != ContactModelKind::kOriginal)
      frame.mean_share = smoothstep(limits::kBlendFrom, limits::kBlendTo, plain.coherence);
    surface_points(hits, frame, result);
    interior_points(hits, frame, result);
    if (frame.stiffness.any()) frame.stiffness.add_to(config_.stiffness, result.contact.stiffness);
    if (frame.shared.any()) result.contact.stiffness += frame.shared.matrix(config_.stiffness, shared_now_);
  }
  shared_points_ = frame.shared_points;
  last_pose_ = hits.pose;
  has_last_pose_ = true;
  return result;
}

/// |x1 - x0| <= |t1 - t0| + |(R1 - R0) p| <= |t1 - t0| + 2 sin(angle / 2) |p|, for every p of the shell.
double ContactStage::motion_bound(const Pose& pose) const noexcept {
  const double half_sine = (last_pose_.orientation.conjugate() * pose.orientation).vec().norm();
  return (pose.position - last_pose_.position).norm() + 2.0 * half_sine * config_.reach_m;
}

void ContactStage::update_shared_direction(const HitList& hits) noexcept {
  // Over the points gone through as well: the rim alone is few points and turns over beyond the tool's equator.
  Vec3 mean = Vec3::Zero();
  double weights = 0.0;
  for (const std::vector<Hit>* list : {&hits.surface, &hits.interior})
    for (const Hit& hit : *list) {
      mean += hit.weight * hit.normal;
      weights += hit.weight;
    }
  const double length = mean.norm();
  const double coherence = weights > 0.0 ? length / weights : 0.0;
  double share = hits.surface.empty() ? 0.0 : smoothstep(limits::kBlendFrom, limits::kBlendTo, coherence);
  if (share > 0.0) mean /= length;
  // While points hang on g, it may be led but not turned over.
  if (shared_points_ > 0) share *= smoothstep(limits::kAgreeFrom, limits::kAgreeTo, mean.dot(shared_));
  if (share >= 1.0) shared_ = mean;
  shared_now_ = shared_;
  // In between only this frame's direction leans: `shared_` itself must not creep while the tool rests. The two are less than
  // 90 degrees apart here, so their mix cannot vanish.
  if (share > 0.0 && share < 1.0 && shared_points_ > 0) shared_now_ = (share * mean + (1.0 - share) * shared_).normalized();
}

Vec3 ContactStage::surface_direction(const Frame& frame, const Hit& hit) const noexcept {
  if (frame.mean_share >= 1.0) return frame.mean;
  if (frame.mean_share <= 0.0) return hit.normal;
  const Vec3 mix = frame.mean_share * frame.mean + (1.0 - frame.mean_share) * hit.normal;
  return mix / std::max(mix.norm(), limits::kShortestDirection);
}

Vec3 ContactStage::held_direction(Push push, const Hit& hit) const noexcept {
  return push == Push::kShared ? shared_now_ : hit.normal;
}

/// Which way a point that has just gone through is pushed from now on.
ContactStage::Push ContactStage::choose_direction(const HitList& hits, const Hit& hit) const noexcept {
  if (shared_.isZero(0.0)) return Push::kOwn;
  const Vec3 arm_before = last_pose_.orientation * (hits.pose.orientation.conjugate() * hit.arm);
  const Vec3 way = (hits.pose.position - last_pose_.position) + (hit.arm - arm_before);
  const bool shared_pushes_back = shared_.dot(way) < 0.0;
  const bool own_pushes_back = hit.normal.dot(way) < 0.0;
  if (config_.model == ContactModelKind::kOriginal)
    return own_pushes_back || !shared_pushes_back ? Push::kOwn : Push::kShared;
  return hit.normal.dot(shared_) >= 0.0 || shared_pushes_back ? Push::kShared : Push::kOwn;
}

void ContactStage::push(const HitList& hits, const Hit& hit, double depth, const Vec3& direction,
                        ContactResult& result) const noexcept {
  const Vec3 force = (config_.stiffness * (hit.weight * depth)) * direction;
  result.wrench.force += force;
  result.wrench.torque += hit.arm.cross(force);
  if (depth > result.deepest_depth_m) {
    result.deepest_depth_m = depth;
    result.deepest_point = hits.pose.position + hit.arm;
  }
}

void ContactStage::count_held(Push push, const Hit& hit, Frame& frame, ContactResult& result) const noexcept {
  result.stiffness_bound_n_per_m += config_.stiffness * hit.weight;
  if (push == Push::kShared) {
    frame.shared.add(hit.arm, hit.weight);
  } else {
    frame.stiffness.add(hit.arm, hit.normal, hit.weight);
  }
}

void ContactStage::surface_points(const HitList& hits, Frame& frame, StageResult& result) noexcept {
  // At both ends of the blend the model has already summed exactly this; only in between is the sum made anew.
  const bool blended = frame.mean_share > 0.0 && frame.mean_share < 1.0;
  if (blended) {
    result.contact.wrench = {};
    result.contact.deepest_depth_m = 0.0;
    result.contact.deepest_point.setZero();
    result.contact.stiffness_bound_n_per_m = 0.0;
    result.contact.stiffness.setZero();
  }
  for (const Hit& hit : hits.surface) {
    const Vec3 direction = surface_direction(frame, hit);
    const double depth = std::max(0.0, direction.dot(hit.to_centre));
    if (blended) {
      push(hits, hit, depth, direction, result.contact);
      if (depth > 0.0) {
        result.contact.stiffness_bound_n_per_m += config_.stiffness * hit.weight;
        frame.stiffness.add(hit.arm, direction, hit.weight);
      }
    }
    Memory& memory = memory_[hit.point];
    const bool returns = memory.frame + 1 == frame_ && memory.push != Push::kPlain;
    const double remembered = returns ? memory.depth_m - limits::kFadePerMetre * frame.moved_m : 0.0;
    if (remembered > depth) {
      push(hits, hit, remembered - depth, held_direction(memory.push, hit), result.contact);
      if (!(depth > 0.0)) count_held(memory.push, hit, frame, result.contact);
      frame.shared_points += memory.push == Push::kShared;
      result.held = true;
      memory = {remembered, frame_, memory.push};
    } else {
      memory = {depth, frame_, Push::kPlain};
    }
  }
}

void ContactStage::interior_points(const HitList& hits, Frame& frame, StageResult& result) noexcept {
  for (const Hit& hit : hits.interior) {
    Memory& memory = memory_[hit.point];
    if (memory.frame + 1 != frame_) {
      memory = {limits::kUnseenDepthEdges * config_.edge_m, frame_, Push::kOwn};
    } else {
      const Push kind = memory.push == Push::kPlain ? choose_direction(hits, hit) : memory.push;
      memory = {std::max(memory.depth_m, limits::kHeldDepthFloorEdges * config_.edge_m), frame_, kind};
    }
    push(hits, hit, memory.depth_m, held_direction(memory.push, hit), result.contact);
    count_held(memory.push, hit, frame, result.contact);
    frame.shared_points += memory.push == Push::kShared;
    result.held = true;
  }
}

}  // namespace voxtouch
