#include "core/rendering/constrained_tool.hpp"

#include <algorithm>
#include <cmath>

#include "core/rendering/exact_tool.hpp"
#include "core/rendering/voxel_tool.hpp"
#include "core/types/motion.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::rendering {
namespace {

std::unique_ptr<ToolSolver> solver_for(const ObjectContacts& objects, double lever_m,
                                       const ExactBodies* bodies) {
  if (bodies == nullptr)
    return std::make_unique<VoxelTool>(objects, lever_m);
  const double reach_m = objects.object(0).renderer->query().reach_m();
  return std::make_unique<ExactTool>(*bodies, objects.size(), lever_m > 0.0 ? lever_m : reach_m);
}

/// Converts a frame to a contact, with a spring of `k` [N/m]. Real-time safe.
contact::ContactResult contact_of(const contact::VirtualToolFrame& frame, double k,
                                  bool displayed) noexcept {
  contact::ContactResult contact;
  contact.pose_status = frame.pose_status;
  contact.surface_hits = frame.surface_hits, contact.interior_hits = frame.interior_hits;
  contact.points_tested = frame.points_tested;
  if (frame.constrained) {
    contact.deepest_point = frame.contact_point, contact.deepest_depth_m = frame.worst_depth_m;
    contact.mean_normal = frame.contact_normal;
    contact.coherence = frame.contact_normal.isZero(0.0) ? 0.0 : 1.0;
    contact.saturated = frame.saturated;
  }
  if (displayed) {
    contact.wrench = frame.wrench(k);
    contact.stiffness = frame.stiffness(k);
    contact.stiffness_bound_n_per_m = k;
  }
  return contact;
}

}  // namespace

ConstrainedTool::ConstrainedTool(ObjectContacts& objects, double lever_m, const ExactBodies* bodies)
    : objects_(objects),
      solver_(solver_for(objects, lever_m, bodies)),
      displacements_(objects.size(), Vec3::Zero()),
      results_(objects.size()) {
  for (std::size_t n = 0; n < objects.size(); ++n)
    parts_.push_back({.object = objects.object(n).id, .contact = &results_[n], .twist = {}});
}

void ConstrainedTool::set_target(double spring_n_per_m) noexcept {
  const double aim = std::isfinite(spring_n_per_m) ? std::max(spring_n_per_m, 0.0) : 0.0;
  if (aim == target_n_per_m_)
    return;
  target_n_per_m_ = aim;
  if (fresh_)
    spring_ = coupling::Ramp(aim);
  else
    spring_.head_for(aim, kSpringRampS);
}

void ConstrainedTool::put_objects(double time_s) noexcept {
  for (std::size_t n = 0; n < displacements_.size(); ++n) {
    const StaticObject& object = objects_.object(n);
    if (!object.moves)
      continue;
    const MotionPoint at = motion_at(*object.moves, time_s);
    displacements_[n] = at.position;
    parts_[n].twist.linear = at.velocity;
  }
}

contact::ContactResult ConstrainedTool::render(const Pose& hand, double time_s, double dt_s,
                                               double friction, ToolFrame& out) noexcept {
  const bool was_placed = solver_->placed() && !fresh_;
  const Pose before = frame_.tool;
  put_objects(time_s);
  if (hand_lost_ || (!fresh_ && (hand.position - hand_.position).norm() > kJumpMPerS * dt_s))
    find_hand(hand);
  frame_ = solver_->frame({.pose = hand, .period_s = dt_s, .friction = friction}, displacements_);
  out = {.constrained = frame_.constrained,
         .not_converged = frame_.not_converged || frame_.moved_too_far,
         .not_initialised = frame_.not_initialised ||
                            frame_.pose_status != contact::PoseStatus::kUsable ||
                            (frame_.constrained && target_n_per_m_ == 0.0),
         .residual_m = frame_.residual_m,
         .queries = static_cast<std::uint32_t>(std::max(frame_.queries, 0)),
         .iterations = static_cast<std::uint32_t>(std::max(frame_.iterations, 0))};
  if (frame_.not_initialised)
    frame_.tool = hand;
  if (frame_.pose_status == contact::PoseStatus::kUsable) {
    hand_ = hand;
    fresh_ = false;
  }
  const double k = spring_.advance(dt_s), displayed = k * frame_.fraction;
  const bool displays_force = frame_.constrained && displayed > 0.0;
  contact::ContactResult contact = contact_of(frame_, k, displays_force);
  if (!contact.wrench.finite() ||
      !contact.stiffness.allFinite()) {  // NaN and infinity are not passed on
    contact.wrench = {}, contact.stiffness.setZero(), contact.stiffness_bound_n_per_m = 0.0;
    solver_->reset();
    out.not_initialised = true;
  }
  const bool follows = was_placed && solver_->placed() && dt_s > 0.0;
  twist_ = {};
  if (follows) {
    twist_.linear = (frame_.tool.position - before.position) / dt_s;
    twist_.angular = rotation_vector(before.orientation, frame_.tool.orientation) / dt_s;
  }
  stiffened_j_ = displayed > displayed_n_per_m_
                     ? 0.5 * (displayed - displayed_n_per_m_) * depth_of_spring2()
                     : 0.0;
  displayed_n_per_m_ = displayed;
  give_parts(displays_force ? displayed : 0.0);
  return contact;
}

/// Handles the return of the hand at `hand`, perhaps behind a wall that the tool has not passed.
void ConstrainedTool::find_hand(const Pose& hand) noexcept {
  hand_lost_ = false;
  if (!solver_->placed())
    return;
  solver_->relocate(hand, displacements_);
  spring_ = coupling::Ramp(0.0);
  spring_.head_for(target_n_per_m_, kSpringRampS);
}

double ConstrainedTool::depth_of_spring2() const noexcept {
  return frame_.constrained ? frame_.shift.squaredNorm() +
                                  frame_.lever_m * frame_.lever_m * frame_.turn.squaredNorm()
                            : 0.0;
}

void ConstrainedTool::give_parts(double displayed_n_per_m) noexcept {
  power_w_ = 0.0;
  const std::span<const Wrench> pushes = solver_->forces();
  for (std::size_t n = 0; n < results_.size(); ++n) {
    contact::ContactResult& part = results_[n];
    part = {};
    if (n >= pushes.size() || !(displayed_n_per_m > 0.0) || pushes[n].zero())
      continue;
    part.wrench = {displayed_n_per_m * pushes[n].force, displayed_n_per_m * pushes[n].torque};
    part.deepest_point = n == frame_.contact_object ? frame_.contact_point : frame_.tool.position;
    part.deepest_depth_m = frame_.worst_depth_m;
    part.stiffness_bound_n_per_m = displayed_n_per_m;
    power_w_ += part.wrench.force.dot(parts_[n].twist.linear);
  }
}

void ConstrainedTool::start_from(const Pose& tool, double time_s) noexcept {
  reset();
  put_objects(time_s);
  solver_->start_at(tool, displacements_);
  if (solver_->placed())
    frame_.tool = tool;
}

void ConstrainedTool::reset() noexcept {
  solver_->reset();
  frame_ = {};
  twist_ = {};
  spring_ = coupling::Ramp(target_n_per_m_);
  displayed_n_per_m_ = power_w_ = stiffened_j_ = 0.0;
  fresh_ = true, hand_lost_ = false;
  for (contact::ContactResult& part : results_)
    part = {};
}

}  // namespace voxtouch::rendering
