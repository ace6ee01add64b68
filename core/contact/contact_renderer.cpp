#include "core/contact/contact_renderer.hpp"

#include <algorithm>

namespace voxtouch {

ContactRenderer::ContactRenderer(const Voxmap& voxmap, Pointshell shell, ContactModelKind model,
                                 const ContactParameters& parameters, const DistanceField* field)
    : query_(voxmap, std::move(shell), parameters.weights),
      model_(make_contact_model(model, parameters, {&voxmap, field, query_.shell().size()})),
      stage_({query_.shell().size(), query_.reach_m(), voxmap.grid().edge, parameters.stiffness, model}) {
  hits_.reserve(query_.shell().size());
}

StageResult ContactRenderer::render(const Pose& tool_in_world) noexcept {
  const ContactResult plain = probe(tool_in_world);
  if (hits_.pose_status != PoseStatus::kUsable) return stage_.apply(hits_, plain, 0.0);
  const double moved_m = stage_.motion_to(hits_.pose);
  if (behind_ || moved_m > contact_limits::kFastEdges * query_.voxmap().grid().edge) return render_fast(plain, moved_m);
  return stage_.apply(hits_, plain, moved_m);
}

/// `plain` is the model's for hits_, at the frame's pose.
StageResult ContactRenderer::render_fast(const ContactResult& plain, double moved_m) noexcept {
  const double edge = query_.voxmap().grid().edge;
  const Pose tool = hits_.pose;
  StageResult result;
  if (behind_) moved_m = MotionPath(tool_pose_, tool).length_m(query_.reach_m());
  if (behind_ && still_behind(tool)) {
    result = entry_;
  } else {
    const MotionPath path(behind_ ? entry_pose_ : stage_.last_pose(), tool);
    const int steps =
        path.steps(query_.reach_m(), contact_limits::kSubStepEdges * edge, contact_limits::kMostSubPoses);
    if (behind_) stage_.reset();  // what it remembers is of the far side
    if (steps <= contact_limits::kMostSubPoses) {
      behind_ = walk(path, steps, result);
    } else {
      behind_ = false;
      result = stage_.apply(hits_, plain, stage_.motion_to(tool));
      result.missed = true;
    }
  }
  tool_pose_ = tool;
  result.fast = moved_m > contact_limits::kFastEdges * edge;
  return result;
}

bool ContactRenderer::still_behind(const Pose& tool) const noexcept {
  const MotionPath path(entry_pose_, tool);
  return path.share(entry_.contact.wrench) < -contact_limits::kAgainstShare &&
         path.length_m(query_.reach_m()) <= 2.0 * query_.reach_m() + swept_m();
}

/// From where the way begins, which the stage gives again as it was, to its end. True where a wall has been crossed: `result` is
/// then the contact on this side of it. Otherwise it is that of the end.
bool ContactRenderer::walk(const MotionPath& path, int steps, StageResult& result) noexcept {
  double most_against_j = 0.0;
  for (int n = 0; n <= steps; ++n) {
    const Pose pose = path.at(static_cast<double>(n) / steps);
    const ContactResult plain = probe(pose);
    result = stage_.apply(hits_, plain, stage_.motion_to(hits_.pose));
    const Wrench& wrench = result.contact.wrench;
    const double share = path.share(wrench), against_j = -path.work_j(wrench);
    if (share < -contact_limits::kAgainstShare && against_j > most_against_j) {
      most_against_j = against_j;
      entry_ = result;
      entry_pose_ = hits_.pose;
    }
    if (most_against_j > 0.0 && (wrench.zero() || share > contact_limits::kAgainstShare)) {
      sub_poses_ += static_cast<std::uint64_t>(n) + 1;
      entry_.crossed = true, entry_.fast = false;
      result = entry_;
      return true;
    }
  }
  sub_poses_ += static_cast<std::uint64_t>(steps) + 1;
  return false;
}

ContactResult ContactRenderer::probe(const Pose& tool_in_world) noexcept {
  ContactResult result;
  query_.find(tool_in_world, hits_);
  model_->evaluate(hits_, result);
  return result;
}

ContactResult ContactRenderer::probe(const Pose& tool_in_world, std::vector<std::uint32_t>& surface_ids) {
  const ContactResult result = probe(tool_in_world);
  surface_ids.clear();
  for (const Hit& hit : hits_.surface) surface_ids.push_back(query_.shell().id[hit.point]);
  std::sort(surface_ids.begin(), surface_ids.end());
  return result;
}

}  // namespace voxtouch
