#include "core/contact/contact_renderer.hpp"

#include <algorithm>

namespace voxtouch::contact {

ContactRenderer::ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell, ContactModelKind model,
                                 const ContactParameters& parameters, const voxmap::DistanceField* field, FrameBudget budget)
    : query_(voxmap, std::move(shell), parameters.weights, std::move(budget.levels)),
      model_(make_contact_model(model, parameters, field)),
      stage_({query_.shell().size(), query_.reach_m(), voxmap.grid().edge, parameters.stiffness, model,
              query_.levels().empty() ? nullptr : query_.levels().levels().stands_in.data()}),
      budget_points_(query_.levels().empty() ? 0 : budget.points), touched_(budget_points_ > 0 ? query_.shell().size() : 0),
      entry_stage_(stage_.config()) {  // not a copy: that would have no room for what a later frame remembers
  hits_.reserve(query_.shell().size());
  if (budget_points_ > 0) hits_.work.reserve(query_.shell().size());
}

StageResult ContactRenderer::render(const Pose& pose_WT) noexcept {
  if (budget_points_ > 0) limit_ = {is_fast(pose_WT) ? budget_points_ / FrameBudget::kLookups : budget_points_, &touched_};
  const ContactResult plain = evaluate_for_stage(pose_WT);
  if (hits_.pose_status != PoseStatus::kUsable) return stage_.apply(hits_, plain, 0.0);
  const double moved_m = stage_.motion_to(hits_.pose_WT);
  if (entry_kind_ != Entry::kNone || moved_m > limits::kFastEdges * query_.voxmap().grid().edge)
    return render_fast(plain, moved_m);
  remember_touched();
  return stage_.apply(hits_, plain, moved_m);
}

/// Whether `render` is going to walk to this pose: as the pose looked up says it, to the bit.
bool ContactRenderer::is_fast(const Pose& pose_WT) const noexcept {
  if (entry_kind_ != Entry::kNone) return true;
  Pose unit = pose_WT;
  return normalise_within(unit.orientation, limits::kMinQuaternionNorm, limits::kMaxQuaternionNorm) &&
         stage_.motion_to(unit) > limits::kFastEdges * query_.voxmap().grid().edge;
}

/// `plain` is the model's for hits_, at the frame's pose.
StageResult ContactRenderer::render_fast(const ContactResult& plain, double moved_m) noexcept {
  const double edge = query_.voxmap().grid().edge;
  const Pose tool = hits_.pose_WT;
  const bool behind = entry_kind_ == Entry::kBehind;
  if (behind) moved_m = MotionPath(tool_pose_, tool).length_m(query_.reach_m());
  tool_pose_ = tool;
  StageResult result;
  if (behind && beyond_entry(tool)) {
    result = entry_;
  } else {
    if (entry_kind_ == Entry::kWatched && !beyond_entry(tool)) entry_kind_ = Entry::kNone;
    const MotionPath path(behind ? entry_pose_ : stage_.last_pose(), tool);
    const int steps = path.steps(query_.reach_m(), limits::kSubStepEdges * edge, limits::kMaxSubPoses);
    const bool walked = steps <= limits::kMaxSubPoses;
    if (behind) leave_far_side(walked);
    if (walked) {
      result = walk(path, steps, plain);
    } else {
      entry_kind_ = Entry::kNone;
      remember_touched();
      result = stage_.apply(hits_, plain, stage_.motion_to(tool));
      result.missed = true;
    }
  }
  result.fast = moved_m > limits::kFastEdges * edge;
  return result;
}

/// What the stage remembers is of the far side.
void ContactRenderer::leave_far_side(bool to_entry) noexcept {
  if (to_entry) {
    stage_ = entry_stage_;  // of the same size: nothing is allocated
  } else {
    stage_.reset();
  }
  entry_kind_ = Entry::kNone;
}

/// Whether the entry's contact stands against the way from there to `tool`, and that is not too far.
bool ContactRenderer::beyond_entry(const Pose& tool) const noexcept {
  const MotionPath path(entry_pose_, tool);
  return path.share(entry_.contact.wrench) < -limits::kAgainstShare &&
         path.length_m(query_.reach_m()) <= 2.0 * query_.reach_m() + swept_m();
}

/// The frame's contact: that of the way's end, or the entry's where the way crosses a wall. Begins with where the last frame ended,
/// which the stage gives again as it was, unless an entry is watched already.
StageResult ContactRenderer::walk(const MotionPath& path, int steps, const ContactResult& plain_at_end) noexcept {
  const bool watched = entry_kind_ == Entry::kWatched;
  const MotionPath along = watched ? MotionPath(entry_pose_, tool_pose_) : path;
  StageResult result;
  for (int n = watched ? 1 : 0; n <= steps; ++n) {
    const bool looked_up = watched && steps == 1;
    const Pose pose = path.at(static_cast<double>(n) / steps);
    const ContactResult plain = looked_up ? plain_at_end : evaluate_for_stage(pose);
    if (!looked_up) ++sub_poses_;
    remember_touched();
    result = stage_.apply(hits_, plain, stage_.motion_to(hits_.pose_WT));
    const Wrench& wrench = result.contact.wrench;
    const double share = along.share(wrench);
    if (entry_kind_ == Entry::kWatched && (wrench.zero() || share > 0.0)) {
      entry_kind_ = Entry::kBehind;
      entry_.crossed = true;
      return entry_;
    }
    if (share < -limits::kAgainstShare &&
        (entry_kind_ == Entry::kNone || along.work_j(wrench) < along.work_j(entry_.contact.wrench))) {
      entry_kind_ = Entry::kWatched;
      entry_ = result;
      entry_stage_ = stage_;
      entry_pose_ = hits_.pose_WT;
    }
  }
  return result;
}

ContactResult ContactRenderer::evaluate_for_stage(const Pose& pose_WT) noexcept {
  ContactResult result;
  query_.find(pose_WT, hits_, limit_);
  model_->evaluate_for_stage(hits_, result);
  return result;
}

ContactResult ContactRenderer::probe(const Pose& pose_WT) noexcept {
  ContactResult result;
  query_.find(pose_WT, hits_, budget_points_ > 0 ? PointLimit{budget_points_, nullptr} : PointLimit{});
  model_->evaluate(hits_, result);
  return result;
}

ContactResult ContactRenderer::probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids) {
  const ContactResult result = probe(pose_WT);
  surface_ids.clear();
  for (const Hit& hit : hits_.surface) surface_ids.push_back(query_.shell().id[hit.point]);
  std::sort(surface_ids.begin(), surface_ids.end());
  return result;
}

}  // namespace voxtouch::contact
