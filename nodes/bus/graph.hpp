#pragma once
/// What ROS 2 tools show of a participant: its node's name, and which endpoints are the node's
/// (`ros2 node list`, `ros2 node info`). Every participant that is a node writes it on
/// `ros_discovery_info`, anew whenever an endpoint comes or goes.
#include <array>
#include <cstdint>
#include <map>
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
  /// Writers and readers of the node, as `ros_discovery_info` lists them. Any thread.
  void add(const Guid& endpoint, qos::Endpoint kind);
  void remove(const Guid& endpoint, qos::Endpoint kind);
  /// From now on names of other participants are read too. Throws Error. Not with DDS Security,
  /// whose participants are all known.
  void read_names();
  /// Takes what participants have written since the last call. Any thread.
  void take_names();
  /// The nodes of a participant as ROS 2 names them ("/talker", "/a and /b"); empty: unknown. Kept
  /// after the participant has gone. Any thread.
  std::string name_of(const Guid& participant) const;

 private:
  static constexpr std::size_t kMaxNames = 256;
  struct Named {
    std::uint64_t order = 0;
    std::string name;
  };
  void write() const;
  template <class Info>
  void write_as() const;
  template <class Info>
  void take_names_as();
  RosNode node_;
  Guid participant_;
  Entity topic_, writer_, names_topic_, names_;
  mutable std::mutex mutex_;
  std::set<Guid> readers_, writers_;
  std::map<Guid, Named> named_;
  std::uint64_t taken_ = 0;
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
