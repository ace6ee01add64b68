#pragma once
/// What ROS 2 tools show of a participant: its node's name, and which endpoints are the node's
/// (`ros2 node list`, `ros2 node info`). Every participant that is a node writes it on
/// `ros_discovery_info`, anew whenever an endpoint comes or goes.
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>

#include "nodes/bus/entity.hpp"
#include "qos/profiles.hpp"

namespace voxtouch::bus {

/// DDS GUID of a participant or an endpoint, as bytes.
using Guid = std::array<std::uint8_t, 16>;

/// The two layouts of that message: a GID has 24 bytes in Humble, 16 in every later ROS 2. A domain
/// holds one of them.
enum class RosGraph : std::uint8_t { kHumble, kIron };

struct RosNode {
  std::string name_space;  ///< "/haptic"
  std::string name{};      ///< "device"
  RosGraph graph = RosGraph::kIron;
};

/// Of one participant, which must be there for as long as endpoints come. Not for the loop.
class Graph {
 public:
  /// Throws Error.
  Graph(dds_entity_t participant, RosNode node);
  /// Writers and readers of the node, as `ros_discovery_info` tells them. Any thread.
  void add(const Guid& endpoint, qos::Endpoint kind);
  void remove(const Guid& endpoint, qos::Endpoint kind);

 private:
  void write() const;
  template <class Info>
  void write_as() const;
  RosNode node_;
  Guid participant_;
  Entity topic_, writer_;
  std::mutex mutex_;
  std::set<Guid> readers_, writers_;
};

/// An endpoint in the graph, for as long as this lives.
class GraphEntry {
 public:
  GraphEntry() = default;
  GraphEntry(std::shared_ptr<Graph> graph, dds_entity_t endpoint, qos::Endpoint kind);
  GraphEntry(GraphEntry&& other) noexcept = default;
  GraphEntry& operator=(GraphEntry&& other) noexcept {
    std::swap(graph_, other.graph_), std::swap(endpoint_, other.endpoint_),
        std::swap(kind_, other.kind_);
    return *this;
  }
  ~GraphEntry() {
    if (graph_)
      graph_->remove(endpoint_, kind_);
  }

 private:
  std::shared_ptr<Graph> graph_;
  Guid endpoint_{};
  qos::Endpoint kind_ = qos::Endpoint::kReader;
};

}  // namespace voxtouch::bus
