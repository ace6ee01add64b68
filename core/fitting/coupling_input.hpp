#pragma once
/// What the coupling is given of a frame of the scene.
#include "core/contact/contact_model.hpp"
#include "core/coupling/coupling.hpp"
#include "core/rendering/scene_renderer.hpp"

namespace voxtouch::fitting {

/// Whether the coupling is told the contact's depth, and may give it the certified stiffness times that. Where each point pushes along its own
/// normal (`original`) a tool that is deep in comes to be as stiff across as along, and the cap holds for that too: what had been
/// given before would have to be taken from it while it goes in.
constexpr bool depth_counts(contact::ContactModelKind model) noexcept {
  return model == contact::ContactModelKind::kAdapted || model == contact::ContactModelKind::kField;
}

/// Of `frame` by `model`, with the tool at `tool` (T in W). Real-time safe.
inline coupling::CouplingInput coupling_input(const rendering::SceneFrame& frame, contact::ContactModelKind model, const Pose& tool) noexcept {
  return {.contact = frame.wrench, .contact_stiffness_n_per_m = frame.stiffness_bound_n_per_m, .contact_stiffness = frame.stiffness, .tool = tool,
          .supplied_energy_j = frame.supplied_energy_j, .contact_depth_m = depth_counts(model) ? frame.touch.contact.deepest_depth_m : 0.0,
          .depth_goes_on = frame.touch.retained};
}

}  // namespace voxtouch::fitting
