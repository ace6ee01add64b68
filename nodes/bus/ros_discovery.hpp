#pragma once
/// Which ROS 2 takes part in the domain.
#include <set>
#include <string>

#include "nodes/bus/participant.hpp"

namespace voxtouch::bus {

/// By the readers of `ros_discovery_info`: from Iron on they announce the hash of its type. Nodes
/// of voxtouch do not count. One thread. Allocates.
class RosDiscovery {
 public:
  /// Throws Error. `own` must outlive it.
  explicit RosDiscovery(const Participant& own);
  /// Takes what was announced since the last call. Does not block.
  void poll();

  std::size_t ros_participants() const noexcept { return ros_; }       ///< also of voxtouch
  std::size_t other_participants() const noexcept { return others_; }  ///< neither of them
  bool has_humble() const noexcept { return has_humble_; }
  bool has_later() const noexcept { return has_later_; }
  /// A sentence if a ring that shows itself as `graph` is not seen by some of them; else empty.
  std::string mismatch(RosGraph graph) const;

 private:
  const Participant& own_;
  Entity participants_, readers_;
  std::set<Guid> own_nodes_;
  std::size_t ros_ = 0, others_ = 0;
  bool has_humble_ = false, has_later_ = false;
};

}  // namespace voxtouch::bus
