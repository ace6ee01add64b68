#include "nodes/bus/exchange.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include <fmt/format.h>

namespace voxtouch::bus {
namespace {

/// A UDP socket that is closed in the destructor.
class Socket {
 public:
  Socket() : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  ~Socket() {
    if (fd_ >= 0)
      close(fd_);
  }
  template <class T>
  bool set(int option, const T& value) const {
    return setsockopt(fd_, IPPROTO_IP, option, &value, sizeof value) == 0;
  }
  int fd() const noexcept { return fd_; }

 private:
  int fd_;
};

/// Sends to `to` over the card; joins a multicast group first.
bool datagram_returns(const Card& card, in_addr to, bool is_group) {
  const Socket receiver, sender;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  socklen_t size = sizeof address;
  auto* const plain = reinterpret_cast<sockaddr*>(&address);
  ip_mreq group{};
  group.imr_interface.s_addr = card.address;
  group.imr_multiaddr = to;
  const in_addr from = group.imr_interface;
  const unsigned char hops = 0;
  if (bind(receiver.fd(), plain, size) != 0 || getsockname(receiver.fd(), plain, &size) != 0)
    return false;
  if (is_group && (!receiver.set(IP_ADD_MEMBERSHIP, group) || !sender.set(IP_MULTICAST_IF, from) ||
                   !sender.set(IP_MULTICAST_TTL, hops)))
    return false;
  address.sin_addr = to;
  if (sendto(sender.fd(), "?", 1, 0, plain, size) != 1)
    return false;
  pollfd waiting{receiver.fd(), POLLIN, 0};
  return poll(&waiting, 1, 200) == 1;
}

/// Whether an element AllowMulticast of this XML disables multicast.
bool disables_multicast(std::string_view xml) {
  const std::size_t at = xml.find("<AllowMulticast>");
  return at != std::string_view::npos && xml.find("false", at) < xml.find("</AllowMulticast>", at);
}

struct Noted {
  std::mutex mutex;
  std::vector<Card> cards;
};
Noted& noted() {
  static Noted all;
  return all;
}

}  // namespace

bool multicast_returns(const Card& card) {
  in_addr group{};
  inet_pton(AF_INET, "239.255.0.1", &group);
  return datagram_returns(card, group, true);
}

bool unicast_returns(const Card& card) {
  return datagram_returns(card, in_addr{card.address}, false);
}

std::string reception_fault(std::string_view interface_name, std::uint32_t domain,
                            std::string_view added) {
  if (const std::string lost = lost_address(); !lost.empty())
    return lost + "; restart the ring";
  if (disables_multicast(added))
    return "CYCLONEDDS_URI disables multicast (AllowMulticast) and lists no peer: remove that, or "
           "use --discovery-peer";
  if (names_cards(added))
    return "CYCLONEDDS_URI selects network cards: check that they are up and the same for all "
           "processes";
  std::vector<Card> cards = network_cards();
  if (interface_name == kThisHost)
    cards = cards_of_this_host(cards);
  else
    std::erase_if(cards, [&](const Card& card) {
      return card.name != interface_name && to_text(card.address) != interface_name;
    });
  if (cards.empty())
    return fmt::format(
        "no network card of '{}' is up: run `ip link set lo up`, or choose another --interface",
        interface_name);
  for (const Card& card : cards) {
    const std::string name = fmt::format("{} ({})", card.name, to_text(card.address));
    if (!unicast_returns(card))
      return fmt::format(
          "UDP to this machine's own address does not arrive on {}: check the firewall", name);
    if (!multicast_returns(card))
      return fmt::format("multicast to 239.255.0.1 does not arrive on {}: check the firewall",
                         name);
  }
  const std::uint32_t port = 7400 + 250 * domain;
  return fmt::format(
      "check that the firewall passes UDP ports {} to {}, and that all processes use the same "
      "domain and network namespace",
      port, port + 249);
}

void note_addresses(const std::vector<Card>& cards) {
  const std::lock_guard lock(noted().mutex);
  noted().cards = cards;
}

std::string lost_address() {
  std::vector<Card> used;
  {
    const std::lock_guard lock(noted().mutex);
    used = noted().cards;
  }
  if (used.empty())
    return {};
  const std::vector<std::uint32_t> here = own_addresses();
  for (const Card& card : used)
    if (std::ranges::find(here, card.address) == here.end())
      return fmt::format("address {} of {} was removed from this machine", to_text(card.address),
                         card.name);
  return {};
}

}  // namespace voxtouch::bus
