#include "core/rendering/constrained_tool.hpp"

#include <algorithm>
#include <cmath>

#include "core/types/motion.hpp"
#include "core/types/rotation_vector.hpp"

namespace voxtouch::rendering {
namespace {

contact::PoseStatus status_of(exact::PoseStatus status) noexcept {
  switch (status) {
    case exact::PoseStatus::kUsable:
      return contact::PoseStatus::kUsable;
    case exact::PoseStatus::kNotAPose:
      return contact::PoseStatus::kNotAPose;
    case exact::PoseStatus::kOutOfRange:
      break;
  }
  return contact::PoseStatus::kOutOfRange;
}

/// Converts a frame to a contact, with a spring of `k` [N/m]. Real-time safe.
contact::ContactResult contact_of(const exact::VirtualToolFrame& frame, double k,
                                  bool displayed) noexcept {
  contact::ContactResult contact;
  contact.pose_status = status_of(frame.pose_status);
  contact.surface_hits = frame.rows;
  contact.points_tested = frame.pairs_seen;
  if (frame.constrained) {
    contact.deepest_point = frame.contact_point;
    contact.mean_normal = frame.contact_normal;
    contact.coherence = frame.contact_normal.isZero(0.0) ? 0.0 : frame.coherence;
  }
  if (displayed) {
    contact.wrench = frame.wrench(k);
    contact.stiffness = frame.stiffness(k);
    contact.stiffness_bound_n_per_m = k;
  }
  return contact;
}

/// Whether the tool has not converged and may continue.
bool lags(const exact::VirtualToolFrame& frame) noexcept {
  if (frame.not_initialised)
    return frame.passed_through;
  const bool free = frame.not_converged && !frame.constrained;
  return free || frame.cut_short || frame.object_delay_m > 0.0 || frame.passed_through;
}

}  // namespace

ConstrainedTool::ConstrainedTool(ObjectContacts& objects, const ExactBodies& bodies, double lever_m)
    : objects_(objects),
      tool_(bodies, objects.size(), lever_m),
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
  const bool was_placed = tool_.placed() && !fresh_;
  const Pose before = frame_.tool;
  put_objects(time_s);
  if (jump_expected_ || (!fresh_ && (hand.position - hand_.position).norm() > kJumpMPerS * dt_s))
    find_hand();
  frame_ = tool_.frame({.pose = hand, .period_s = dt_s, .friction = friction}, displacements_);
  out = {.constrained = frame_.constrained,
         .not_converged = lags(frame_),
         .not_initialised = frame_.not_initialised ||
                            frame_.pose_status != exact::PoseStatus::kUsable ||
                            (frame_.constrained && target_n_per_m_ == 0.0),
         .residual_m = frame_.residual_m,
         .queries = static_cast<std::uint32_t>(std::max(frame_.queries, 0)),
         .work = frame_.work,
         .at_work_limit = frame_.cut_short};
  if (frame_.not_initialised)
    frame_.tool = hand;
  if (frame_.pose_status == exact::PoseStatus::kUsable) {
    hand_ = hand;
    fresh_ = false;
  }
  const double k = spring_.advance(dt_s), displayed = k * frame_.ratio;
  const bool displays_force = frame_.constrained && displayed > 0.0;
  contact::ContactResult contact = contact_of(frame_, k, displays_force);
  if (!contact.wrench.finite() ||
      !contact.stiffness.allFinite()) {  // NaN and infinity are not passed on
    contact.wrench = {}, contact.stiffness.setZero(), contact.stiffness_bound_n_per_m = 0.0;
    tool_.reset();
    out.not_initialised = true;
  }
  const bool follows = was_placed && tool_.placed() && dt_s > 0.0;
  twist_ = {};
  if (follows) {
    twist_.linear = (frame_.tool.position - before.position) / dt_s;
    twist_.angular = rotation_vector(before.orientation, frame_.tool.orientation) / dt_s;
  }
  stiffened_j_ = displayed > displayed_n_per_m_
                     ? 0.5 * (displayed - displayed_n_per_m_) * depth_of_spring2()
                     : 0.0;
  displayed_n_per_m_ = displayed;
  set_parts(displays_force ? displayed : 0.0);
  return contact;
}

/// Handles the return of the hand, perhaps behind a wall that the tool has not passed.
void ConstrainedTool::find_hand() noexcept {
  jump_expected_ = false;
  if (!tool_.placed())
    return;
  tool_.relocate();
  spring_ = coupling::Ramp(0.0);
  spring_.head_for(target_n_per_m_, kSpringRampS);
}

double ConstrainedTool::depth_of_spring2() const noexcept {
  return frame_.constrained ? frame_.shift.squaredNorm() +
                                  frame_.lever_m * frame_.lever_m * frame_.rotation.squaredNorm()
                            : 0.0;
}

void ConstrainedTool::set_parts(double displayed_n_per_m) noexcept {
  power_w_ = 0.0;
  const std::span<const Wrench> forces = tool_.forces();
  for (std::size_t n = 0; n < results_.size(); ++n) {
    contact::ContactResult& part = results_[n];
    part = {};
    if (n >= forces.size() || !(displayed_n_per_m > 0.0) || forces[n].zero())
      continue;
    part.wrench = {displayed_n_per_m * forces[n].force, displayed_n_per_m * forces[n].torque};
    part.deepest_point = n == frame_.contact_owner ? frame_.contact_point : frame_.tool.position;
    part.stiffness_bound_n_per_m = displayed_n_per_m;
    power_w_ += part.wrench.force.dot(parts_[n].twist.linear);
  }
}

void ConstrainedTool::start_from(const Pose& tool, double time_s) noexcept {
  reset();
  put_objects(time_s);
  tool_.start_at(tool);
  if (tool_.placed())
    frame_.tool = tool;
}

void ConstrainedTool::reset() noexcept {
  tool_.reset();
  frame_ = {};
  twist_ = {};
  spring_ = coupling::Ramp(target_n_per_m_);
  displayed_n_per_m_ = power_w_ = stiffened_j_ = 0.0;
  fresh_ = true, jump_expected_ = false;
  for (contact::ContactResult& part : results_)
    part = {};
}

}  // namespace voxtouch::rendering
