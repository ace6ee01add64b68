#include "core/contact/field_model.hpp"

#include "core/contact/limits.hpp"
#include "core/contact/push_sums.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {
namespace {

/// Sums over the hits of one frame.
struct Sums {
  Vec3 normals = Vec3::Zero();
  double weights = 0.0;
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();  ///< for k = 1
  double stiffness = 0.0;                            ///< likewise
  StiffnessSum along;
};

void add_push(const Hit& hit, const voxmap::FieldSample& sample, double depth, Sums& sums) noexcept {
  const Vec3 push = (hit.weight * depth) * hit.normal;
  sums.force += push;
  sums.torque += hit.arm.cross(push);
  const double steepness = sample.gradient.norm();
  if (!(steepness > 0.0)) return;
  sums.stiffness += hit.weight * steepness;
  sums.along.add(hit.arm, hit.normal, 0.5 * hit.weight * steepness);
  sums.along.add(hit.arm, sample.gradient, 0.5 * hit.weight / steepness);  // |g|/2 h h' = g g' / (2 |g|)
}

/// Whether moving the point deeper would meet no more push: beyond what the field holds; near the middle of a body, where
/// the gradient fades; or beyond it, where the push points away from the nearest way out.
bool at_its_end(const Hit& hit, const voxmap::FieldSample& sample) noexcept {
  constexpr double kFlat = limits::kFlatGradient;
  return sample.saturated || sample.gradient.squaredNorm() < kFlat * kFlat || hit.normal.dot(sample.gradient) < -kFlat;
}

}  // namespace

void FieldModel::evaluate(const HitList& hits, ContactResult& result) const noexcept {
  begin_result(hits, result);
  if (hits.surface.empty() && hits.interior.empty()) return;

  const voxmap::Grid& grid = field_.grid();
  const Vec3 local = hits.pose_WT.position - grid.origin;  // first, so that a grid at 1e6 m costs no digits of the arms
  Sums sums;
  for (const Hits* list : {&hits.surface, &hits.interior})
    for (const Hit& hit : *list) {
      sums.normals += hit.weight * hit.normal;
      sums.weights += hit.weight;
      const voxmap::FieldSample sample = field_.at((local + hit.arm) / grid.edge);
      const double depth = -sample.distance_m;
      if (!(hit.weight * depth > 0.0)) continue;  // a point without an area does not push
      add_push(hit, sample, depth, sums);
      result.saturated = result.saturated || at_its_end(hit, sample);
      if (depth > result.deepest_depth_m) {
        result.deepest_depth_m = depth;
        result.deepest_point = hits.pose_WT.position + hit.arm;
      }
    }
  tell_mean_normal(sums.normals, sums.weights, result);
  result.wrench = {stiffness_ * sums.force, stiffness_ * sums.torque};
  result.stiffness_bound_n_per_m = stiffness_ * sums.stiffness;
  if (sums.along.any()) sums.along.add_to(stiffness_, result.stiffness);
}

}  // namespace voxtouch::contact
