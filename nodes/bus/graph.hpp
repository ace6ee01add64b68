#pragma once
/// Presents a participant to ROS 2 tools (`ros2 node list`, `ros2 node info`): the name of its node
/// and the node's endpoints. Each participant that is a node publishes this on `ros_discovery_info`
/// whenever an endpoint is created or deleted.
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

/// The two layouts of that message: a GID has 24 bytes in Humble and 16 in later versions of ROS 2.
/// A domain uses one of them.
enum class RosGraph : std::uint8_t { kHumble, kIron };

struct RosNode {
  std::string name_space;  ///< "/haptic"
  std::string name{};      ///< "device"
  RosGraph graph = RosGraph::kIron;
};

/// The graph entry of one participant, which must outlive the last added endpoint. Not for the
/// loop.
class Graph {
 public:
  /// Throws Error.
  Graph(dds_entity_t participant, RosNode node);
  /// Adds or removes a writer or reader of the node in `ros_discovery_info`. Any thread.
  void add(const Guid& endpoint, qos::Endpoint kind);
  void remove(const Guid& endpoint, qos::Endpoint kind);
  /// Also reads the names of other participants from now on. Throws Error. Not used with DDS
  /// Security, where all participants are identified.
  void read_names();
  /// Reads the names published since the last call. Any thread.
  void take_names();
  /// The nodes of a participant as ROS 2 names them ("/talker", "/a and /b"); empty if unknown. The
  /// name is kept after the participant leaves. Any thread.
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

/// Keeps an endpoint in the graph during its lifetime.
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
