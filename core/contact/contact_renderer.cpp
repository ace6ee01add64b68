#include "core/contact/contact_renderer.hpp"

#include <algorithm>

namespace voxtouch::contact {

ContactRenderer::ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell, ContactModelKind model,
                                 const ContactParameters& parameters, const voxmap::DistanceField* field, FrameBudget budget)
    : query_(voxmap, std::move(shell), parameters.weights, std::move(budget.levels)),
      model_(make_contact_model(model, parameters, field)),
      stage_({query_.shell().size(), query_.reach_m(), voxmap.grid().edge, parameters.stiffness, model,
              query_.levels().empty() ? nullptr : query_.levels().levels().stands_in.data()}),
      budget_points_(query_.levels().empty() ? 0 : budget.points), touched_(budget_points_ > 0 ? query_.shell().size() : 0) {
  hits_.reserve(query_.shell().size());
  if (budget_points_ > 0) hits_.work.reserve(query_.shell().size());
}

StageResult ContactRenderer::render(const Pose& pose_WT) noexcept {
  const PointLimit limit = budget_points_ > 0 ? PointLimit{budget_points_, &touched_} : PointLimit{};
  ContactResult plain;
  query_.find(pose_WT, hits_, limit);
  model_->evaluate_for_stage(hits_, plain);
  if (hits_.pose_status != PoseStatus::kUsable) return stage_.apply(hits_, plain, 0.0);
  if (budget_points_ > 0) touched_.take(hits_);
  const double moved_m = stage_.motion_to(hits_.pose_WT);
  StageResult result = stage_.apply(hits_, plain, moved_m);
  result.missed = result.fast && near_within(moved_m);
  return result;
}

/// Whether anything of the scene may lie where some point of the tool has been since it moved by `moved_m` to where it is.
bool ContactRenderer::near_within(double moved_m) const noexcept {
  const voxmap::Voxmap& map = query_.voxmap();
  const double edge = map.grid().edge;
  const double free_m = edge * map.free_distance_voxels((hits_.pose_WT.position - map.grid().origin) / edge);
  return !(free_m > query_.reach_m() + moved_m);
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
