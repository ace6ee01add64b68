#include "devices/arm/udp_socket.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace voxtouch::arm {
namespace {

sockaddr_in to_system(const UdpEndpoint& endpoint) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(endpoint.address);
  address.sin_port = htons(endpoint.port);
  return address;
}

UdpEndpoint from_system(const sockaddr_in& address) noexcept {
  return {ntohl(address.sin_addr.s_addr), ntohs(address.sin_port)};
}

/// Age since the kernel received the datagram; zero without a stamp. Both stamps use the wall
/// clock. Its rare steps make one packet appear too old or too new.
std::chrono::nanoseconds age_of(msghdr& message) noexcept {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part; part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS)
      continue;
    timespec arrived{}, now{};
    std::memcpy(&arrived, CMSG_DATA(part), sizeof arrived);
    clock_gettime(CLOCK_REALTIME, &now);
    const std::chrono::nanoseconds age = std::chrono::seconds(now.tv_sec - arrived.tv_sec) +
                                         std::chrono::nanoseconds(now.tv_nsec - arrived.tv_nsec);
    return std::max(age, std::chrono::nanoseconds(0));
  }
  return std::chrono::nanoseconds(0);
}

std::string advice(int error, std::uint16_t port) {
  if (error == EADDRINUSE)
    return fmt::format(
        "the port is in use: end that program ('ss -ulnp sport = {}'), or use another port here "
        "and on the controller",
        port);
  if (error == EADDRNOTAVAIL)
    return "no network interface of this machine has this address: see 'ip address'";
  if (error == EACCES)
    return "ports below 1024 need privileges: use another port";
  return "check the address and the network";
}

}  // namespace

std::string text_of(const UdpEndpoint& endpoint) {
  const std::uint32_t a = endpoint.address;
  return fmt::format("{}.{}.{}.{}:{}", a >> 24, a >> 16 & 255, a >> 8 & 255, a & 255,
                     endpoint.port);
}

std::optional<std::uint32_t> parse_ipv4(const std::string& text) noexcept {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1)
    return std::nullopt;
  return ntohl(address.s_addr);
}

UdpSocket::UdpSocket(const std::string& address, std::uint16_t port) {
  const auto host = parse_ipv4(address);
  if (!host)
    throw devices::DeviceOpenError(
        fmt::format("'{}' is not an IPv4 address, such as 192.168.0.10", address));
  file_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (file_ < 0)
    throw devices::DeviceOpenError(
        fmt::format("cannot create a UDP socket: {}", std::strerror(errno)));
  const int on = 1;
  // Without it the age of a packet is unknown and counts as zero.
  setsockopt(file_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  const sockaddr_in requested = to_system({*host, port});
  if (bind(file_, reinterpret_cast<const sockaddr*>(&requested), sizeof requested) != 0) {
    const int error = errno;
    close(file_);
    throw devices::DeviceOpenError(fmt::format("cannot receive on UDP {}:{}: {}; {}", address, port,
                                               std::strerror(error), advice(error, port)));
  }
  sockaddr_in bound{};
  socklen_t size = sizeof bound;
  getsockname(file_, reinterpret_cast<sockaddr*>(&bound), &size);
  local_ = from_system(bound);
}

UdpSocket::~UdpSocket() { close(file_); }

bool UdpSocket::wait(std::chrono::nanoseconds timeout) noexcept {
  const auto end = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const auto left =
        std::max(end - std::chrono::steady_clock::now(), std::chrono::steady_clock::duration(0));
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(left);
    const timespec limit{static_cast<time_t>(seconds.count()),
                         static_cast<long>((left - seconds).count())};
    pollfd requested{file_, POLLIN, 0};
    const int ready = ppoll(&requested, 1, &limit, nullptr);
    if (ready > 0)
      return true;
    if (ready == 0)
      return false;
    if (errno != EINTR)
      return false;
  }
}

std::optional<UdpSocket::Datagram> UdpSocket::receive(std::span<std::byte> buffer) noexcept {
  sockaddr_in from{};
  iovec part{buffer.data(), buffer.size()};
  alignas(cmsghdr) std::byte control[128];
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof control;
  for (;;) {
    // MSG_TRUNC: the true size, also if it exceeds the buffer.
    const ssize_t size = recvmsg(file_, &message, MSG_TRUNC);
    if (size >= 0)
      return Datagram{static_cast<std::size_t>(size), from_system(from), age_of(message)};
    if (errno == EINTR)
      continue;
    return std::nullopt;
  }
}

bool UdpSocket::send(std::span<const std::byte> datagram, const UdpEndpoint& to) noexcept {
  const sockaddr_in address = to_system(to);
  for (;;) {
    const ssize_t sent = sendto(file_, datagram.data(), datagram.size(), MSG_DONTWAIT,
                                reinterpret_cast<const sockaddr*>(&address), sizeof address);
    if (sent == static_cast<ssize_t>(datagram.size()))
      return true;
    if (sent < 0 && errno == EINTR)
      continue;
    return false;
  }
}

}  // namespace voxtouch::arm
