#pragma once
/// Topics and nodes of a scene's ring.
#include <vector>

#include "core/rendering/plan.hpp"

namespace voxtouch::rendering_node {

/// One part for each topic of qos::kTopics and each node, and why it is there. None has an expected
/// time: a message's cost is the latency that `voxtouch up` shows.
std::vector<rendering::PlanPart> ring_parts(const scene::Scene& scene);

}  // namespace voxtouch::rendering_node
