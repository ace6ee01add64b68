#pragma once
/// One DDS participant a node: where it joins the network.
#include <array>
#include <cstdint>
#include <string>

#include "nodes/bus/entity.hpp"

namespace voxtouch::bus {

/// DDS GUID of a participant, as bytes.
using Guid = std::array<std::uint8_t, 16>;

struct ParticipantOptions {
  std::uint32_t domain = 0;              ///< as ROS_DOMAIN_ID
  std::string network_interface = "lo";  ///< ignored where CYCLONEDDS_URI is set: then that configuration holds
  std::string name = "voxtouch";         ///< seen by DDS tools
};

/// Announces itself as ROS 2 does (USER_DATA "enclave=/;"). Threads of Cyclone DDS inherit the caller's scheduling: set it first.
class Participant {
 public:
  /// Throws Error, naming the interface and the domain.
  explicit Participant(const ParticipantOptions& options);

  dds_entity_t get() const noexcept { return entity_.get(); }
  const Guid& guid() const noexcept { return guid_; }

 private:
  Entity entity_;
  Guid guid_{};
};

}  // namespace voxtouch::bus
