#include "nodes/bag/names.hpp"

#include <fmt/format.h>

namespace voxtouch::bag {
namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// rmw's enumerations (rmw/types.h). kTransient and kPersistent have none; to a late reader they look like
// transient local.
int rmw_history(bus::History history) { return history == bus::History::kKeepAll ? 2 : 1; }
int rmw_reliability(bus::Reliability reliability) { return reliability == bus::Reliability::kReliable ? 1 : 2; }
int rmw_durability(bus::Durability durability) { return durability == bus::Durability::kVolatile ? 2 : 1; }
int rmw_liveliness(bus::Liveliness liveliness) {
  switch (liveliness) {
    case bus::Liveliness::kAutomatic: return 1;
    case bus::Liveliness::kManualByParticipant: return 2;
    case bus::Liveliness::kManualByTopic: return 3;
  }
  return 1;
}

// For ever is the largest int64 in ns, which rmw splits in the same way.
std::string rmw_duration(std::string_view name, std::int64_t ns) {
  return fmt::format("  {}:\n    sec: {}\n    nsec: {}\n", name, ns / 1'000'000'000, ns % 1'000'000'000);
}

}  // namespace

std::string ros_topic_name(std::string_view dds_name) {
  if (dds_name.starts_with("rt/")) return std::string(dds_name.substr(2));
  return dds_name.starts_with('/') ? std::string(dds_name) : fmt::format("/{}", dds_name);
}

std::string dds_topic_name(std::string_view ros_name) {
  return fmt::format("rt{}{}", ros_name.starts_with('/') ? "" : "/", ros_name);
}

std::string ros_type_name(std::string_view dds_name) {
  const auto inner = dds_name.find("::dds_::");
  if (inner == std::string_view::npos || !dds_name.ends_with('_')) return std::string(dds_name);
  std::string name(dds_name.substr(0, dds_name.size() - 1));
  name.replace(inner, 8, "::");
  return replaced(name, "::", "/");
}

std::string dds_type_name(std::string_view ros_name) {
  const auto last = ros_name.rfind('/');
  if (last == std::string_view::npos) return std::string(ros_name);
  return fmt::format("{}::dds_::{}_", replaced(std::string(ros_name.substr(0, last)), "/", "::"),
                     ros_name.substr(last + 1));
}

std::string offered_qos_text(std::span<const bus::EndpointQos> writers) {
  std::string text;
  for (const auto& qos : writers) {
    text += fmt::format("- history: {}\n  depth: {}\n  reliability: {}\n  durability: {}\n", rmw_history(qos.history),
                        qos.history == bus::History::kKeepAll ? 0 : qos.depth, rmw_reliability(qos.reliability),
                        rmw_durability(qos.durability));
    text += rmw_duration("deadline", qos.deadline_ns) + rmw_duration("lifespan", qos.lifespan_ns);
    text += fmt::format("  liveliness: {}\n", rmw_liveliness(qos.liveliness));
    text += rmw_duration("liveliness_lease_duration", qos.lease_ns) + "  avoid_ros_namespace_conventions: false\n";
  }
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace voxtouch::bag
