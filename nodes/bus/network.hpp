#pragma once
/// Network of a DDS domain: its network cards, its discovery peers, and the hosts that it can
/// receive.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace voxtouch::bus {

/// Interface name for this machine only: loopback and its network cards, closed to other machines.
/// ROS 2 tools listen on a card or on loopback, so they find the ring with any setting.
inline constexpr std::string_view kThisHost = "host";

/// A network card with its first IPv4 address (network byte order).
struct Card {
  std::string name;
  std::uint32_t address = 0;
  bool is_loopback = false, is_multicast = false;
};

/// For example "10.0.0.1".
std::string to_text(std::uint32_t address);

/// The active cards in the order of the system, which DDS also uses.
std::vector<Card> network_cards();
/// All IPv4 addresses of active cards.
std::vector<std::uint32_t> own_addresses();

/// Loopback and the first three cards with multicast. DDS accepts no more, and a card without
/// multicast would disable it for all.
std::vector<Card> cards_of_this_host(const std::vector<Card>& cards);

struct Network {
  std::string configuration;  ///< of DDS
  bool is_closed = false;     ///< to other machines
};

/// The built-in settings followed by CYCLONEDDS_URI (`added`), which overrides them. If `added`
/// names network cards, they replace `interface_name`. `peers` are hosts that discovery contacts
/// directly, also without multicast. Throws Error if peers are given for a closed network, and if
/// `added` is truncated, enables shared memory, or names a file that configures nothing.
Network network_of(std::string_view interface_name, const std::vector<std::string>& peers,
                   std::string_view added);

/// Whether this text (XML and file names, as in CYCLONEDDS_URI) names network cards.
bool names_cards(std::string_view configuration);

/// UDP sockets of this process, including inherited ones.
std::vector<int> udp_sockets();

/// Whether this machine has no other participant in the domain and no other host can be received.
/// Determined from the kernel's socket list, since a participant holds a port of its domain during
/// its whole lifetime. `own` sockets are ignored. Returns false if the list is not conclusive: a
/// network card or peers lead to other machines, CYCLONEDDS_URI (`added`) may change the ports, or
/// no list is readable.
bool is_alone_in_domain(std::uint32_t domain, std::string_view interface_name,
                        const std::vector<std::string>& peers, std::string_view added,
                        const std::vector<int>& own);

/// Restricts these sockets to datagrams from addresses of this machine. Throws Error.
void close_to_other_hosts(const std::vector<int>& sockets);

}  // namespace voxtouch::bus
