#pragma once
/// Checks of this machine and its network: what impairs a ring, or its discovery by ROS 2 tools.
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
  kWarning,
  kBad
};  ///< kBad: a ring cannot run as requested

struct Finding {
  Health health;
  std::string sentence;
};

/// Whether the requested interface exists, and whether each card works; sends one multicast
/// datagram over each.
std::vector<Finding> check_cards(std::string_view interface_name,
                                 const std::vector<bus::Card>& cards);

/// Used participant indices of `domain`, from the ports in /proc/net/udp.
std::set<unsigned> taken_indices(std::istream& udp, std::uint32_t domain);
/// How many are left for a ring and for tools.
Finding check_indices(const std::set<unsigned>& taken);

/// Real-time scheduling, locked memory, receive buffers.
std::vector<Finding> check_rights();

/// The environment of a ROS 2 process (rmw_cyclonedds) that is to find a ring on these, whatever
/// its own settings are.
std::string ros_environment(std::uint32_t domain, std::string_view interface_name);

}  // namespace voxtouch::cli
