#pragma once
/// A node's state in the words of ROS's life cycle, to be asked for: `/<rig>/<node>/get_state`. It
/// can be read, not set.
#include <cstdint>
#include <string>
#include <string_view>

#include "nodes/bus/service_server.hpp"
#include "nodes/log/few_a_second.hpp"
#include "nodes/runtime/node_registry.hpp"

namespace voxtouch::runtime {

/// lifecycle_msgs' number and name of a state.
struct LifeCycleState {
  std::uint8_t id = 0;
  std::string_view label;
};
LifeCycleState life_cycle_state(NodeState state) noexcept;

/// Not for the loop.
class LifeCycle {
 public:
  LifeCycle(const bus::Participant& participant, std::string_view node, const std::string& rig);
  /// Answers who has asked since the last call: 100 a second at most. Does not block.
  void serve(NodeState state);

 private:
  bus::ServiceServer<msg::lifecycle_msgs_GetState> states_;
  log::FewASecond admitted_{100};
};

}  // namespace voxtouch::runtime
