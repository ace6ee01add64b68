#pragma once
/// Which writers are on the network: the builtin publication topic as plain values.
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "nodes/bus/opaque.hpp"

namespace voxtouch::bus {

using Guid = std::array<std::uint8_t, 16>;

/// A writer as its participant announces it. After it has gone only `guid` is filled and `alive` is false.
struct DiscoveredWriter {
  Guid guid{};
  Guid participant{};
  bool alive = false;
  std::string topic;      ///< DDS name, e.g. "rt/haptic/device/state"
  std::string type_name;  ///< DDS name, e.g. "voxtouch_msgs::msg::dds_::DeviceState_"
  EndpointQos qos;
  std::string user_data;              ///< as announced, e.g. "typehash=RIHS01_...;" from ROS 2
  bool has_type_information = false;  ///< XTypes; false for ROS 2 writers, and for those of this process
  bool keyed = false;                 ///< an opaque reader never matches it
};

/// Reports each writer that appears, changes or goes, also those of the participant itself.
class WriterDiscovery {
 public:
  static OpaqueResult<WriterDiscovery> create(dds_entity_t participant, const dds_listener_t* listener = nullptr);

  /// Calls `f` for every change since the last call. Does not block. Returns how many.
  OpaqueResult<std::size_t> take(const std::function<void(const DiscoveredWriter&)>& f);

  /// For waitsets.
  dds_entity_t handle() const noexcept { return entity_.get(); }

 private:
  explicit WriterDiscovery(OwnedEntity entity) : entity_(std::move(entity)) {}
  OwnedEntity entity_;
};

}  // namespace voxtouch::bus
