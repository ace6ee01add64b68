#pragma once
/// The plan as a latched message.
#include "core/scene/plan.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::rendering {

/// With the parts of the ring behind those of the plan. `from_sample`: the first one that it holds for; 0 where a session begins.
void publish_plan(bus::Writer<msg::ScenePlan>& writer, const Scene& scene, const Plan& plan, double largest_shell_gap_m,
                  std::uint64_t session, std::uint64_t from_sample = 0);

}  // namespace voxtouch::rendering
