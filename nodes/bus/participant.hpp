#pragma once
/// One DDS participant a node: where it joins the network.
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodes/bus/entity.hpp"
#include "nodes/bus/graph.hpp"

namespace voxtouch::bus {

struct ParticipantOptions {
  std::uint32_t domain = 0;  ///< as ROS_DOMAIN_ID
  std::string network_interface =
      "host";  ///< kThisHost, or a network card; cards that CYCLONEDDS_URI names hold instead
  std::string name = "voxtouch";  ///< seen by DDS tools
  std::vector<std::string>
      discovery_peers{};  ///< other hosts to ask, where multicast does not reach them
  RosNode node{};         ///< what ROS 2 tools show it as; without a name: not at all
  std::vector<std::pair<std::string, std::string>>
      security{};  ///< properties of DDS Security (nodes/security); none: plain
};

/// Announces itself as ROS 2 does (USER_DATA "enclave=/;voxtouch=1;"). Threads of Cyclone DDS
/// inherit the caller's scheduling: set it first.
class Participant {
 public:
  /// Throws Error, naming the interface and the domain.
  explicit Participant(const ParticipantOptions& options);

  dds_entity_t get() const noexcept { return entity_.get(); }
  const Guid& guid() const noexcept { return guid_; }
  /// The ROS graph as this participant sees it; null: it is no node.
  const std::shared_ptr<Graph>& graph() const noexcept { return graph_; }
  /// Shows an endpoint of this participant to ROS 2 tools, while the entry lives.
  GraphEntry enter(dds_entity_t endpoint, qos::Endpoint kind) const {
    return graph_ ? GraphEntry(graph_, endpoint, kind) : GraphEntry();
  }

 private:
  Entity entity_;
  std::shared_ptr<Graph> graph_;
  Guid guid_{};
};

}  // namespace voxtouch::bus
