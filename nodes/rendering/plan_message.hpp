#pragma once
/// The plan as a latched message.
#include "core/scene/plan.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::rendering {

/// With the parts of the ring behind those of the plan.
void publish_plan(bus::Writer<msg::ScenePlan>& writer, const Scene& scene, const Plan& plan, double largest_shell_gap_m,
                  std::uint64_t session);

}  // namespace voxtouch::rendering
