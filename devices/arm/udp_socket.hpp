#pragma once
/// A bound UDP socket (IPv4). After construction no function allocates or throws.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "devices/driver.hpp"

namespace voxtouch::arm {

/// An IPv4 address and port in host byte order.
struct UdpEndpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
  bool operator==(const UdpEndpoint&) const = default;
};
/// "192.168.0.20:49938". Allocates.
std::string text_of(const UdpEndpoint& endpoint);
/// Parses a dotted address; nullopt if it is invalid.
std::optional<std::uint32_t> parse_ipv4(const std::string& text) noexcept;

class UdpSocket {
 public:
  /// Binds `address` (dotted; "0.0.0.0" = every interface) and `port` (0: a free one). No other
  /// program may use the port. Throws DeviceOpenError with address, port, the system's error and a
  /// remedy.
  UdpSocket(const std::string& address, std::uint16_t port);
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  struct Datagram {
    std::size_t size = 0;  ///< of the datagram; larger than the buffer: truncated
    UdpEndpoint from;
    std::chrono::nanoseconds age{0};  ///< waiting time in the kernel
  };
  /// Waits for a datagram, at most `timeout`. Returns false without one. Signals do not interrupt
  /// the wait.
  bool wait(std::chrono::nanoseconds timeout) noexcept;
  /// The oldest waiting datagram, or nullopt.
  std::optional<Datagram> receive(std::span<std::byte> buffer) noexcept;
  /// Returns false if the system refused it.
  bool send(std::span<const std::byte> datagram, const UdpEndpoint& to) noexcept;

  UdpEndpoint local() const noexcept { return local_; }

 private:
  int file_ = -1;
  UdpEndpoint local_;
};

}  // namespace voxtouch::arm
