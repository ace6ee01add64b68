#include "nodes/rendering/plan_ring.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "qos/topics.hpp"

namespace voxtouch::rendering_node {
namespace {

/// Names the writer of a topic, for messages.
std::string writer_of(const qos::Topic& topic) {
  if (topic.writers == qos::kEveryNode)
    return "every node";
  if (topic.of_launcher)
    return "up";
  return fmt::format(
      "{}", fmt::join(qos::names_of(topic.writers ? topic.writers : topic.readers & ~qos::kLogger),
                      ", "));
}

std::string name_of(const qos::Topic& topic, const effects::EffectSpec* external) {
  const bool elsewhere =
      topic.path == qos::kExternalWrench.path && external != nullptr && !external->text.empty();
  return fmt::format("topic {}", elsewhere ? std::string_view(external->text) : topic.path);
}

rendering::PlanPart node_part(const char* name, std::string why) {
  return {.name = fmt::format("node {}", name), .node = name, .why = std::move(why)};
}

}  // namespace

std::vector<rendering::PlanPart> ring_parts(const scene::Scene& scene) {
  std::vector<rendering::PlanPart> parts;
  const effects::EffectSpec* external = effects::external_of(scene.effects);
  for (const qos::Topic& topic : qos::kTopics)
    if ((external != nullptr || !topic.with_external) && !topic.with_led_hand)
      parts.push_back({.name = name_of(topic, external),
                       .node = writer_of(topic),
                       .why = std::string(topic.why)});
  parts.push_back(node_part("device", "Reads the device and limits its force."));
  parts.push_back(node_part("rendering", scene.effects.empty()
                                             ? "Computes the contact of each sample."
                                             : "Computes contact and effects of each sample."));
  parts.push_back(node_part("coupling", scene.design ? "Designs the coupling and runs it."
                                                     : "Runs the scene's coupling."));
  parts.push_back(node_part("validator",
                            "Separate process, started by `up`. Checks every n-th contact while "
                            "its topic has a reader."));
  parts.push_back(node_part("logger", "Records the bag. Not started with --no-record."));
  return parts;
}

}  // namespace voxtouch::rendering_node
