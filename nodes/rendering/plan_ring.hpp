#pragma once
/// Topics and nodes of a scene's ring.
#include <vector>

#include "core/rendering/plan.hpp"

namespace voxtouch::rendering_node {

/// One part for each topic of qos::kTopics and each node, with its reason. No part has an expected
/// time: the cost of a message is the latency that `voxtouch up` reports.
std::vector<rendering::PlanPart> ring_parts(const scene::Scene& scene);

}  // namespace voxtouch::rendering_node
