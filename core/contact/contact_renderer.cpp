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
  return stage_.apply(hits_, probe(tool_in_world));
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
