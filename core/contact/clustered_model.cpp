#include "core/contact/clustered_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/contact/limits.hpp"
#include "core/contact/patch_normals.hpp"
#include "core/contact/push_sums.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {

ClusteredModel::ClusteredModel(const voxmap::Voxmap& voxmap, std::size_t points, double stiffness)
    : voxmap_(voxmap), stiffness_(stiffness), planes_(points) {}

/// Calls f(hit, its plane) for all hits, surface first.
template <class F>
static void for_each(const HitList& hits, const std::vector<BlendedPlane>& planes, F&& f) noexcept {
  const BlendedPlane* plane = planes.data();
  for (const Hits* list : {&hits.surface, &hits.interior})
    for (const Hit& hit : *list) f(hit, *plane++);
}

void ClusteredModel::look_up(const HitList& hits) const noexcept {
  const voxmap::Grid& grid = voxmap_.grid();
  const Vec3 local = hits.pose_WT.position - grid.origin;  // first, so that a grid at 1e6 m costs no digits of the arms
  std::size_t n = 0;
  for (const Hits* list : {&hits.surface, &hits.interior})
    for (const Hit& hit : *list) planes_[n++] = blended_plane(voxmap_, (local + hit.arm) / grid.edge);
}

void ClusteredModel::evaluate(const HitList& hits, ContactResult& result) const noexcept {
  begin_result(hits, result);
  const std::size_t count = hits.surface.size() + hits.interior.size();
  if (count == 0 || count > planes_.size()) return;
  look_up(hits);

  PatchNormals patches;
  Vec3 normals = Vec3::Zero();
  double weights = 0.0;
  for_each(hits, planes_, [&](const Hit& hit, const BlendedPlane& plane) {
    normals += hit.weight * hit.normal;
    weights += hit.weight;
    const double depth = plane.depth(hit.normal) + limits::kPatchReachEdges;
    if (depth > 0.0) patches.add(hit.normal, hit.weight * plane.inside * depth);
  });

  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  double pushing = 0.0;
  StiffnessSum sum;
  for_each(hits, planes_, [&](const Hit& hit, const BlendedPlane& plane) {
    const Vec3 mean = patches.mean_near(hit.normal);
    const double depth = plane.inside * std::max(0.0, plane.depth(mean)) * voxmap_.grid().edge;
    if (!(hit.weight * depth > 0.0)) return;
    force += (hit.weight * depth * hit.normal.dot(mean)) * mean;
    torque += (hit.weight * depth) * hit.arm.cross(hit.normal);
    pushing += hit.weight;
    sum.add(hit.arm, mean, 0.5 * hit.weight);
    sum.add(hit.arm, hit.normal, 0.5 * hit.weight);
    result.saturated = result.saturated || plane.surface < limits::kSurfaceWeight;
    if (depth > result.deepest_depth_m) {
      result.deepest_depth_m = depth;
      result.deepest_point = hits.pose_WT.position + hit.arm;
    }
  });
  tell_mean_normal(normals, weights, result);
  result.wrench = {stiffness_ * force, stiffness_ * torque};
  result.stiffness_bound_n_per_m = stiffness_ * pushing;
  if (sum.any()) sum.add_to(stiffness_, result.stiffness);
}

std::unique_ptr<ContactModel> make_clustered_model(const ContactParameters& parameters, const ContactGround& ground) {
  if (parameters.weights != PointWeights::kArea)
    throw std::invalid_argument(
        "contact: the model 'clustered' weighs points by their area; give its stiffness per area (stiffness_n_per_m3)");
  if (ground.voxmap == nullptr)
    throw std::invalid_argument("contact: the model 'clustered' needs the voxmap that its hits come from");
  return std::make_unique<ClusteredModel>(*ground.voxmap, ground.points, parameters.stiffness);
}

}  // namespace voxtouch::contact
