#pragma once
/// Where a DDS domain lives: on which network cards, which other hosts it asks, and which hosts can
/// be received.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::bus {

/// Stands for an interface: this machine over loopback and its network cards, closed to other
/// machines. ROS 2 tools, which listen on a card or on loopback, find the ring so, whatever their
/// settings are.
inline constexpr std::string_view kThisHost = "host";

/// A network card with its first IPv4 address (in network order).
struct Card {
  std::string name;
  std::uint32_t address = 0;
  bool is_loopback = false, is_multicast = false;
};

/// "10.0.0.1".
std::string to_text(std::uint32_t address);

/// The cards that are up, in the system's order, which is that in which DDS looks for one.
std::vector<Card> network_cards();
/// All IPv4 addresses of cards that are up.
std::vector<std::uint32_t> own_addresses();

/// Loopback and the first three cards that can do multicast: more DDS does not take, and one
/// without would switch multicast off for all.
std::vector<Card> cards_of_this_host(const std::vector<Card>& cards);

struct Network {
  std::string configuration;  ///< of DDS
  bool is_closed = false;     ///< to other machines
};

/// The built-in settings, and behind them what CYCLONEDDS_URI says (`added`), which overrides where
/// both say something. Where that names network cards, those hold instead of `interface_name`.
/// `peers` are other hosts to ask, also where multicast does not work. Throws Error where peers are
/// to be asked from a network that is closed to them, and where `added` enables shared memory.
Network network_of(std::string_view interface_name, const std::vector<std::string>& peers,
                   std::string_view added);

/// Whether this text (XML and names of files, as in CYCLONEDDS_URI) names network cards.
bool names_cards(std::string_view configuration);

/// UDP sockets of this process, also those that it inherited.
std::vector<int> udp_sockets();

/// Whether no other participant of this machine is in the domain, and no host can be received: by
/// the kernel's list of sockets, for each participant has a port of its domain from before it says
/// anything until it has gone. `own` sockets do not count. False as well where the list does not
/// state it: a network card or hosts to ask lead to other machines, CYCLONEDDS_URI
/// (`added`) may have moved the ports, no list can be read.
bool is_alone_in_domain(std::uint32_t domain, std::string_view interface_name,
                        const std::vector<std::string>& peers, std::string_view added,
                        const std::vector<int>& own);

/// From now on these sockets receive what comes from an address of this machine and nothing else.
/// Throws Error.
void close_to_other_hosts(const std::vector<int>& sockets);

}  // namespace voxtouch::bus
