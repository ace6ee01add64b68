#pragma once
/// Publishes the plan as a latched message.
#include "core/device_fit/scene_requirements.hpp"
#include "core/rendering/plan.hpp"
#include "nodes/bus/writer.hpp"

namespace voxtouch::rendering_node {

/// Includes the parts of the ring and the requirements on the device. `from_sample`: first sample
/// that the plan is valid for; 0 at the start of a session.
void publish_plan(bus::Writer<msg::ScenePlan>& writer, const scene::Scene& scene,
                  const rendering::Plan& plan, const device_fit::SceneRequirements& demand,
                  double largest_shell_gap_m, std::uint64_t session, std::uint64_t from_sample);

}  // namespace voxtouch::rendering_node
