#include "core/contact/contact_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace voxtouch::contact {
namespace {

/// Centre of the shell's area, if it is inside. The solid angle of the shell seen from an inner
/// point is 4 pi, from an outer point 0 (Gauss).
std::optional<Vec3> middle_inside(const pointshell::Pointshell& shell) {
  Vec3 sum = Vec3::Zero();
  double area_m2 = 0.0, solid_angle = 0.0;
  for (std::size_t p = 0; p < shell.size(); ++p)
    sum += shell.area_m2[p] * shell.point(p), area_m2 += shell.area_m2[p];
  const Vec3 middle = sum / area_m2;
  for (std::size_t p = 0; p < shell.size(); ++p) {
    const Vec3 arm = shell.point(p) - middle;
    solid_angle -=
        shell.area_m2[p] * shell.coherence[p] * shell.normal(p).dot(arm) / std::pow(arm.norm(), 3);
  }
  return solid_angle > 2.0 * std::numbers::pi ? std::optional(middle) : std::nullopt;
}

}  // namespace

ContactRenderer::ContactRenderer(const voxmap::Voxmap& voxmap, pointshell::Pointshell shell,
                                 ContactModelKind model, const ContactParameters& parameters,
                                 const voxmap::DistanceField* field)
    : query_(voxmap, std::move(shell), parameters.weights),
      model_(make_contact_model(model, parameters, field)),
      stage_({query_.shell().size(), query_.reach_m(), voxmap.grid().edge, parameters.stiffness,
              model, parameters.memoryless}),
      memoryless_(parameters.memoryless),
      middle_T_(memoryless_ ? middle_inside(query_.shell()) : std::nullopt) {
  hits_.reserve(query_.shell().size());
}

StageResult ContactRenderer::render(const Pose& pose_WT) noexcept {
  find(pose_WT);
  return render_found();
}

void ContactRenderer::share_normals(std::span<ContactRenderer* const> members) noexcept {
  for (Hits HitList::*const part : {&HitList::surface, &HitList::interior}) {
    Vec3 normals = Vec3::Zero();
    double weights = 0.0;
    for (const ContactRenderer* const member : members) {
      normals += (member->hits_.*part).normal_sum();
      weights += (member->hits_.*part).weight_sum();
    }
    for (ContactRenderer* const member : members)
      (member->hits_.*part).set_sums(normals, weights);
  }
}

void ContactRenderer::share_memory(std::span<ContactRenderer* const> members) noexcept {
  for (const ContactRenderer* const member : members.subspan(1))
    members.front()->stage_.merge_memory(member->stage_);
  for (ContactRenderer* const member : members.subspan(1))
    member->stage_.copy_memory(members.front()->stage_);
}

StageResult ContactRenderer::render_found() noexcept {
  ContactResult plain;
  if (memoryless_)
    model_->evaluate(hits_, plain);
  else
    model_->evaluate_for_stage(hits_, plain);
  if (hits_.pose_status != PoseStatus::kUsable)
    return stage_.apply(hits_, plain, 0.0);
  const double moved_m = stage_.motion_to(hits_.pose_WT);
  StageResult result = stage_.apply(hits_, plain, moved_m);
  result.tunnelling_suspected = result.fast && near_within(moved_m);
  result.passed_through = tool_centre_in_solid();
  return result;
}

bool ContactRenderer::tool_centre_in_solid() const noexcept {
  if (!middle_T_)
    return false;
  const voxmap::Voxmap& map = query_.voxmap();
  const Vec3 u = map.grid().to_grid(hits_.pose_WT * *middle_T_);
  return u.cwiseAbs().maxCoeff() < limits::kMaxGridCoordinate &&
         map.at(voxmap::Grid::voxel_of(u)) != voxmap::VoxelKind::kFree;
}

/// Whether any voxel of the scene may be within `moved_m` of some point of the tool.
bool ContactRenderer::near_within(double moved_m) const noexcept {
  const voxmap::Voxmap& map = query_.voxmap();
  const double edge = map.grid().edge;
  const double free_m =
      edge * map.free_distance_voxels((hits_.pose_WT.position - map.grid().origin) / edge);
  return !(free_m > query_.reach_m() + moved_m);
}

ContactResult ContactRenderer::probe(const Pose& pose_WT) noexcept {
  ContactResult result;
  query_.find(pose_WT, hits_);
  model_->evaluate(hits_, result);
  return result;
}

ContactResult ContactRenderer::probe(const Pose& pose_WT, std::vector<std::uint32_t>& surface_ids) {
  find(pose_WT);
  return probe_found(surface_ids);
}

ContactResult ContactRenderer::probe_found(std::vector<std::uint32_t>& surface_ids) const {
  ContactResult result;
  model_->evaluate(hits_, result);
  surface_ids.clear();
  for (const Hit& hit : hits_.surface)
    surface_ids.push_back(query_.shell().id[hit.point]);
  std::sort(surface_ids.begin(), surface_ids.end());
  return result;
}

}  // namespace voxtouch::contact
