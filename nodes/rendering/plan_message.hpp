#pragma once
/// The plan as a latched message.
#include "core/device_fit/scene_requirements.hpp"
#include "core/rendering/plan.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::rendering_node {

/// With the ring's parts and what is demanded of the device. `from_sample`: the first that it holds
/// for; 0: a session begins.
void publish_plan(bus::Writer<msg::ScenePlan>& writer, const scene::Scene& scene,
                  const rendering::Plan& plan, const device_fit::SceneRequirements& demand,
                  double largest_shell_gap_m, std::uint64_t session, std::uint64_t from_sample);

}  // namespace voxtouch::rendering_node
