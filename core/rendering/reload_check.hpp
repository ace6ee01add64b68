#pragma once
/// A scene that is read again while it runs: what may differ, and what stays as it was set by hand
/// meanwhile.
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.hpp"

namespace voxtouch::rendering {

/// Why `next` cannot take the place of `running` without a restart, as a sentence; empty where it
/// can. Another `device` or `coupling` section belongs to nodes that do not read the file again.
/// Meshes, voxel size, contact and effects may differ, and are judged on the device by who knows it
/// (fit_coupling.hpp); motions are not looked at.
std::string reload_refusal(const scene::Scene& running, const scene::Scene& next);

/// The effects of `next` as they are to run. One that the file still asks for in the same words
/// keeps what was changed while running (`now`, the state of `before`'s effects); where the file
/// has changed, the file counts.
std::vector<effects::EffectSpec> carried_over(std::span<const effects::EffectSpec> before,
                                              std::span<const effects::EffectSpec> now,
                                              std::span<const effects::EffectSpec> next);

}  // namespace voxtouch::rendering
