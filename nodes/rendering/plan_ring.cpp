#include "nodes/rendering/plan_ring.hpp"

#include <fmt/format.h>

#include "qos/topics.hpp"

namespace voxtouch::rendering {
namespace {

struct Caller {
  const qos::Topic& topic;
  const char* node;  ///< that writes it
  const char* why;
};

// Kept true by ros_outputs.cpp (matched_count before each write), roster.cpp (diagnostics) and the nodes' readers.
constexpr Caller kCallers[] = {
    {qos::kDeviceState, "device", "Each sample of it is answered by rendering and coupling."},
    {qos::kContactState, "rendering", "The coupling turns each into a command."},
    {qos::kForceCommand, "coupling", "The device applies each; this closes the ring."},
    {qos::kDeviceDescription, "device", "It begins a session, and the coupling is designed for it. Once a session."},
    {qos::kScenePlan, "rendering", "The coupling is designed for the contact that it tells of. Once a session."},
    {qos::kCouplingDesign, "coupling", "People and bags see from it what runs. Once a session and on a change."},
    {qos::kValidation, "validator", "Verdicts; made only while a validator runs and somebody reads them."},
    {qos::kNodeStatus, "every node", "Nodes find each other by it. Ten times a second and on a change."},
    {qos::kEffectChange, "rendering", "Who changes the scene while it runs writes it: voxtouch change, or any ROS 2 tool."},
    {qos::kEffectChanged, "rendering", "What became of each change."},
    {qos::kDiagnostics, "every node", "For ROS tools; made and written only while somebody reads it."},
    {qos::kTf, "rendering", "For ROS tools; made and written only while somebody reads it, outside the loop."},
    {qos::kPose, "rendering", "For ROS tools; made and written only while somebody reads it, outside the loop."},
    {qos::kWrench, "rendering", "For ROS tools; made and written only while somebody reads it, outside the loop."},
    {qos::kMarkers, "rendering", "For ROS tools; made and written only while somebody reads it, outside the loop."},
};

PlanPart node_part(const char* name, std::string why) {
  return {.name = fmt::format("node {}", name), .node = name, .why = std::move(why)};
}

}  // namespace

std::vector<PlanPart> ring_parts(const Scene& scene) {
  std::vector<PlanPart> parts;
  for (const Caller& caller : kCallers)
    parts.push_back({.name = fmt::format("topic {}", caller.topic.path), .node = caller.node, .why = caller.why});
  parts.push_back(node_part("device", "Reads the device and keeps its force within limits."));
  parts.push_back(node_part("rendering",
                            scene.effects.empty() ? "Contact of each sample." : "Contact and effects of each sample."));
  parts.push_back(
      node_part("coupling", scene.design ? "Designs the coupling and runs it." : "Runs the scene's coupling."));
  parts.push_back(node_part("validator",
                            "A process of its own beside the ring, started by `up`: judges every n-th contact while somebody reads its verdicts. "
                            "Where none runs, nothing is done for it."));
  parts.push_back(node_part("logger", "Records the bag; with --no-record there is none, and nothing is done for it."));
  return parts;
}

}  // namespace voxtouch::rendering
