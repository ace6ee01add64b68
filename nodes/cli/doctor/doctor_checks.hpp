#pragma once
/// What of this machine and its network keeps a ring from running well, or ROS 2 tools from finding
/// it.
#include <cstdint>
#include <istream>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "nodes/bus/network.hpp"

namespace voxtouch::cli {

enum class Health : std::uint8_t {
  kGood,
  kMind,
  kBad
};  ///< kBad: a ring cannot run, or not as it is asked to

struct Finding {
  Health health;
  std::string sentence;
};

/// Whether the interface that is asked for is there, and what each card is good for; sends one
/// datagram by multicast over each.
std::vector<Finding> check_cards(std::string_view interface_name,
                                 const std::vector<bus::Card>& cards);

/// Participant indices of `domain` that are taken, by what /proc/net/udp says of ports.
std::set<unsigned> taken_indices(std::istream& udp, std::uint32_t domain);
/// How many are left for a ring and for tools.
Finding check_indices(const std::set<unsigned>& taken);

/// Real-time scheduling, locked memory, receive buffers.
std::vector<Finding> check_rights();

/// The environment of a ROS 2 process (rmw_cyclonedds) that is to find a ring on these, whatever
/// its own settings are.
std::string ros_environment(std::uint32_t domain, std::string_view interface_name);

}  // namespace voxtouch::cli
