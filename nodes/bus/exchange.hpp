#pragma once
/// Whether datagrams of this machine reach its own sockets, and why processes may not receive each
/// other.
#include <cstdint>
#include <string>
#include <string_view>

#include "nodes/bus/network.hpp"

namespace voxtouch::bus {

/// Sends one datagram over the card, to DDS's group or to the card's own address, and waits 200 ms
/// for it.
bool multicast_returns(const Card& card);
bool unicast_returns(const Card& card);

/// The likely cause if nothing comes from processes that are known to run, with what to do.
/// `added`: what CYCLONEDDS_URI holds.
std::string deafness_cause(std::string_view interface_name, std::uint32_t domain,
                           std::string_view added);

/// The addresses that DDS uses in this process, as `configure` notes them.
void note_addresses(const std::vector<Card>& cards);
/// One of them that this machine has no more, for people: "address 10.0.0.5 of eth0 is gone".
/// Empty: all are there.
std::string lost_address();

}  // namespace voxtouch::bus
