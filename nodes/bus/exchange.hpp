#pragma once
/// Checks whether datagrams of this machine reach its own sockets, and why processes may not
/// receive each other.
#include <cstdint>
#include <string>
#include <string_view>

#include "nodes/bus/network.hpp"

namespace voxtouch::bus {

/// Sends one datagram over the card, to the group of DDS or to the card's own address, and waits up
/// to 200 ms for it.
bool multicast_returns(const Card& card);
bool unicast_returns(const Card& card);

/// The likely cause, with a remedy, if no message of a running process arrives. `added`: value of
/// CYCLONEDDS_URI.
std::string reception_fault(std::string_view interface_name, std::uint32_t domain,
                            std::string_view added);

/// Stores the addresses that DDS uses in this process; called by `configure`.
void note_addresses(const std::vector<Card>& cards);
/// Describes a stored address that this machine has lost: "address 10.0.0.5 of eth0 was removed
/// from this machine". Empty if all are present.
std::string lost_address();

}  // namespace voxtouch::bus
