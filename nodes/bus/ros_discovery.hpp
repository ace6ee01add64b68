#pragma once
/// Detects which version of ROS 2 participates in the domain.
#include <set>
#include <string>

#include "nodes/bus/participant.hpp"

namespace voxtouch::bus {

/// Uses the readers of `ros_discovery_info`: since Iron they announce the hash of its type. Nodes
/// of voxtouch are ignored. One thread. Allocates.
class RosDiscovery {
 public:
  /// Throws Error. `own` must outlive it.
  explicit RosDiscovery(const Participant& own);
  /// Takes the announcements since the last call. Does not block.
  void poll();

  std::size_t ros_participants() const noexcept { return ros_; }  ///< includes voxtouch
  /// Neither ROS 2 nor voxtouch.
  std::size_t other_participants() const noexcept { return others_; }
  bool has_humble() const noexcept { return has_humble_; }
  bool has_later() const noexcept { return has_later_; }
  /// A sentence if some participants cannot discover a ring that uses the layout `graph`; else
  /// empty.
  std::string mismatch(RosGraph graph) const;

 private:
  const Participant& own_;
  Entity participants_, readers_;
  std::set<Guid> own_nodes_;
  std::size_t ros_ = 0, others_ = 0;
  bool has_humble_ = false, has_later_ = false;
};

}  // namespace voxtouch::bus
