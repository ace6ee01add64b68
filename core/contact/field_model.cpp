#include "core/contact/field_model.hpp"

#include "core/contact/field_samples.hpp"
#include "core/contact/penalty_sums.hpp"
#include "core/contact/stiffness_sum.hpp"

namespace voxtouch::contact {

void FieldModel::evaluate(const HitList& hits, ContactResult& result) const noexcept {
  begin_result(hits, result);
  if (hits.surface.empty() && hits.interior.empty())
    return;
  StiffnessSum sum;
  for (const Hits* list : {&hits.surface, &hits.interior})
    if (!list->empty())
      add_forces(*list, hits.pose_WT.position, sum, result);
  set_mean_normal(hits.surface.normal_sum() + hits.interior.normal_sum(),
                  hits.surface.weight_sum() + hits.interior.weight_sum(), result);
  if (sum.any())
    sum.add_to(stiffness_, result.stiffness);
}

void FieldModel::add_forces(const Hits& hits, const Vec3& tool, StiffnessSum& sum,
                            ContactResult& result) const noexcept {
  const Vec3 local = tool - field_.grid().origin;  // subtracted first, so that a grid at 1e6 m
                                                   // costs no digits of the arms
  const double depth_voxels = field_.arrays().depth_voxels;
  const PenaltyKernel& kernel = penalty_kernel(instructions());
  PenaltyLanes lanes;
  HitBlock block;
  FieldSamples samples;
  PenaltyForces along_normal, along_gradient;
  for (std::size_t begin = 0; begin < hits.size(); begin += HitBlock::kHits) {
    fill_block(kernel, hits, begin, block);
    sample_block(field_, local, block, samples);
    if (field_forces(block, samples, depth_voxels, along_normal, along_gradient, lanes))
      result.saturated = true;
    if (along_normal.groups == 0)
      continue;
    kernel.add(block, along_normal, lanes);
    kernel.add_stiffness(block, along_gradient, lanes);
  }
  add_lanes(hits, lanes, stiffness_, tool, result, sum);
}

}  // namespace voxtouch::contact
