#pragma once
/// A virtual tool against the exact ball that is drawn to the same hand.
#include <vector>

#include "core/accuracy/accuracy.hpp"
#include "core/accuracy/contact_places.hpp"
#include "core/reference/reference_scene.hpp"
#include "core/rendering/build.hpp"

namespace voxtouch::accuracy {

/// Hand this deep at each place [voxel edges of the setting]: a virtual tool is not asked about the depth of a layer.
inline constexpr double kHandDepthEdges = 5.0;

/// Fills contacts, missed, direction, noise, torque and times of `row`; an onset is none of its figures (NaN). Throws
/// std::runtime_error, a sentence, where the tool is no declared sphere about its origin.
void judge_tool(const scene::Scene& scene, rendering::BuiltScene& built, const reference::ReferenceScene& reference,
                const std::vector<ContactPlace>& places, const AccuracyOptions& options, AccuracyRow& row);

}  // namespace voxtouch::accuracy
