#include "core/contact/field_model.hpp"

#include "core/contact/limits.hpp"
#include "core/contact/push_sums.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {
namespace {

/// Whether moving the point deeper would meet no more push: beyond what the field holds; near the middle of a body, where
/// the gradient fades; or beyond it, where the push points away from the nearest way out.
bool at_its_end(const Vec3& normal, const voxmap::FieldSample& sample) noexcept {
  constexpr double kFlat = limits::kFlatGradient;
  return sample.saturated || sample.gradient.squaredNorm() < kFlat * kFlat || normal.dot(sample.gradient) < -kFlat;
}

}  // namespace

void FieldModel::evaluate(const HitList& hits, ContactResult& result) const noexcept {
  begin_result(hits, result);
  if (hits.surface.empty() && hits.interior.empty()) return;
  StiffnessSum sum;
  for (const Hits* list : {&hits.surface, &hits.interior})
    if (!list->empty()) add_pushes(*list, hits.pose_WT.position, sum, result);
  tell_mean_normal(hits.surface.normal_sum() + hits.interior.normal_sum(), hits.surface.weight_sum() + hits.interior.weight_sum(), result);
  if (sum.any()) sum.add_to(stiffness_, result.stiffness);
}

void FieldModel::add_pushes(const Hits& hits, const Vec3& tool, StiffnessSum& sum, ContactResult& result) const noexcept {
  const voxmap::Grid& grid = field_.grid();
  const Vec3 local = tool - grid.origin;  // first, so that a grid at 1e6 m costs no digits of the arms
  const PushKernel& kernel = push_kernel(instructions());
  PushLanes lanes;
  HitBlock block;
  Pushes along_normal, along_gradient;
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    fill_block(kernel, hits, begin, block);
    bool any = false;
    for (std::size_t n = 0; n < block.filled(); ++n) {
      const Vec3 arm(block.arm[0][n], block.arm[1][n], block.arm[2][n]);
      const Vec3 normal(block.normal[0][n], block.normal[1][n], block.normal[2][n]);
      const voxmap::FieldSample sample = n < block.count ? field_.at((local + arm) / grid.edge) : voxmap::FieldSample{};
      const double weight = block.weight[n], depth = -sample.distance_m, push = weight * depth;
      const bool pushes = push > 0.0;  // a point without an area does not
      const double steepness = sample.gradient.norm();
      const Vec3 gradient = steepness > 0.0 ? Vec3(sample.gradient * (1.0 / steepness)) : sample.gradient;
      for (int axis = 0; axis < 3; ++axis) along_normal.j[axis][n] = normal[axis], along_gradient.j[axis][n] = gradient[axis];
      along_normal.push[n] = pushes ? push : 0.0, along_gradient.push[n] = 0.0;
      along_normal.weight[n] = along_gradient.weight[n] = pushes ? 0.5 * weight * steepness : 0.0;
      if (!pushes) continue;
      any = true;
      result.saturated = result.saturated || at_its_end(normal, sample);
      const std::size_t lane = n % kLanes;
      if (depth > lanes.deepest[lane]) lanes.deepest[lane] = depth, lanes.deepest_hit[lane] = static_cast<double>(begin + n - lane);
    }
    if (!any) continue;
    kernel.add(block, along_normal, lanes);
    kernel.add(block, along_gradient, lanes);
  }
  add_lanes(hits, lanes, stiffness_, tool, result, sum);
}

}  // namespace voxtouch::contact
