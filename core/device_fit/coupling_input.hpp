#pragma once
/// Input of the coupling from a frame of the scene.
#include "core/contact/contact_model.hpp"
#include "core/coupling/coupling.hpp"
#include "core/rendering/scene_renderer.hpp"

namespace voxtouch::device_fit {

/// Of `frame`, with the tool at `tool` (T in W). Real-time safe.
inline coupling::CouplingInput coupling_input(const rendering::SceneFrame& frame,
                                              const Pose& tool) noexcept {
  return {.contact = frame.wrench,
          .contact_stiffness_n_per_m = frame.stiffness_bound_n_per_m,
          .contact_stiffness = frame.stiffness,
          .tool = tool,
          .coherence = coupling::coherence_of(frame.touch.contact.surface_hits,
                                              frame.touch.contact.coherence),
          .supplied_energy_j = frame.supplied_energy_j};
}

}  // namespace voxtouch::device_fit
