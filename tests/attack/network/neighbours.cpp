#include "tests/attack/network/neighbours.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace voxtouch::attack {
namespace {

constexpr std::size_t kHeader = 20;  // "RTPS", version, vendor, prefix
constexpr std::uint16_t kUnicast = 0x31,
                        kDiscoveryUnicast = 0x32;  // parameters that hold a locator

class Socket {
 public:
  explicit Socket(std::uint32_t domain) : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const int yes = 1;
    setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = htons(discovery_port(domain));
    ip_mreq group{};
    inet_pton(AF_INET, "239.255.0.1", &group.imr_multiaddr);
    inet_pton(AF_INET, "127.0.0.1", &group.imr_interface);
    const timeval wait{0, 50'000};
    if (bind(fd_, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0 ||
        setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0 ||
        setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait) != 0) {
      const std::string why = std::strerror(errno);
      close(fd_);
      throw std::runtime_error("the announcements of domain " + std::to_string(domain) +
                               " cannot be listened to: " + why + ".");
    }
  }
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Empty if nothing was received for 50 ms.
  Bytes receive() const {
    Bytes bytes(65536);
    const ssize_t n = recv(fd_, bytes.data(), bytes.size(), 0);
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }

 private:
  int fd_;
};

/// Numbers as Cyclone DDS writes them on this machine: little endian. Zero behind the end.
template <class T>
T number(const Bytes& bytes, std::size_t at) {
  T value = 0;
  if (at + sizeof value <= bytes.size())
    std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void collect_ports(const Bytes& bytes, std::size_t at, std::size_t end,
                   std::set<std::uint16_t>& ports) {
  while (at + 4 <= end) {
    const auto id = number<std::uint16_t>(bytes, at), size = number<std::uint16_t>(bytes, at + 2);
    // a locator: kind, port, address of 16 bytes
    if ((id == kUnicast || id == kDiscoveryUnicast) && size == 24 && bytes[at + 24] == 127)
      ports.insert(static_cast<std::uint16_t>(number<std::uint32_t>(bytes, at + 8)));
    at += 4U + size;
  }
}

}  // namespace

Neighbours listen_for_neighbours(std::uint32_t domain, std::chrono::milliseconds time) {
  const Socket socket(domain);
  Neighbours found;
  const auto until = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < until) {
    Bytes bytes = socket.receive();
    if (bytes.size() < kHeader || std::memcmp(bytes.data(), "RTPS", 4) != 0)
      continue;
    GuidPrefix prefix{};
    std::copy_n(bytes.begin() + 8, prefix.size(), prefix.begin());
    for (std::size_t at = kHeader; at + 4 <= bytes.size();) {
      const std::size_t size = number<std::uint16_t>(bytes, at + 2),
                        end = size ? at + 4 + size : bytes.size();
      // 20 bytes of the submessage, then 4 for the encoding of the parameters
      if (bytes[at] == kData)
        collect_ports(bytes, at + 28, std::min(end, bytes.size()), found.ports);
      if (bytes[at] == kData && found.prefixes.insert(prefix).second)
        found.announcements.push_back(bytes);
      at = end;
    }
  }
  return found;
}

}  // namespace voxtouch::attack
