#pragma once
/// Topics and nodes that stand round a scene: which of them work always, which only while somebody
/// reads or runs them.
#include <vector>

#include "core/rendering/plan.hpp"

namespace voxtouch::rendering_node {

/// One part for each topic of qos::kTopics and each node, with what calls for it. None has a time
/// of its own in a frame: what a message costs is the latency that `voxtouch up` shows.
std::vector<rendering::PlanPart> ring_parts(const scene::Scene& scene);

}  // namespace voxtouch::rendering_node
