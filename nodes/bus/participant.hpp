#pragma once
/// The DDS participant of a node.
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
  /// kThisHost or a network card; cards named in CYCLONEDDS_URI replace it.
  std::string network_interface = "host";
  std::string name = "voxtouch";               ///< shown by DDS tools
  std::vector<std::string> discovery_peers{};  ///< Hosts that discovery contacts directly, for
                                               ///< networks without multicast.
  RosNode node{};  ///< name for ROS 2 tools; without a name it is not listed
  std::vector<std::pair<std::string, std::string>>
      security{};  ///< properties of DDS Security (nodes/security); empty: no security
};

/// A participant that announces itself as ROS 2 does (USER_DATA "enclave=/;voxtouch=1;"). The
/// threads of Cyclone DDS inherit the caller's scheduling, so set it first.
class Participant {
 public:
  /// Throws Error, naming the interface and the domain.
  explicit Participant(const ParticipantOptions& options);

  dds_entity_t get() const noexcept { return entity_.get(); }
  const Guid& guid() const noexcept { return guid_; }
  /// The ROS graph as seen by this participant; null if it is not a node.
  const std::shared_ptr<Graph>& graph() const noexcept { return graph_; }
  /// Shows an endpoint of this participant to ROS 2 tools during the lifetime of the entry.
  GraphEntry enter(dds_entity_t endpoint, qos::Endpoint kind) const {
    return graph_ ? GraphEntry(graph_, endpoint, kind) : GraphEntry();
  }

 private:
  Entity entity_;
  std::shared_ptr<Graph> graph_;
  Guid guid_{};
};

}  // namespace voxtouch::bus
