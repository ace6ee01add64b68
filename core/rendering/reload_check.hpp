#pragma once
/// Reload of a running scene: allowed differences, and settings that are kept from the running
/// scene.
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// Returns, as a sentence, why `next` cannot replace `running` without a restart, or an empty text.
/// A different `device` or `coupling` section belongs to nodes that do not reload the file. Meshes,
/// voxel size, contact and effects may differ; fit_coupling.hpp checks them for the device. Motions
/// are ignored.
std::string reload_refusal(const scene::Scene& running, const scene::Scene& next);

/// The effect settings that `next` starts with. An effect with unchanged text in the file keeps its
/// run-time changes (`now`, the state of `before`'s effects). If its text has changed, the file
/// takes precedence.
std::vector<effects::EffectSpec> carried_over(std::span<const effects::EffectSpec> before,
                                              std::span<const effects::EffectSpec> now,
                                              std::span<const effects::EffectSpec> next);

}  // namespace voxtouch::rendering
