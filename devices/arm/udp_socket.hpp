#pragma once
/// A bound UDP socket (IPv4). After construction nothing allocates or throws.
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
/// Dotted address; nullopt if it is none.
std::optional<std::uint32_t> parse_ipv4(const std::string& text) noexcept;

class UdpSocket {
 public:
  /// Binds `address` (dotted; "0.0.0.0" = every interface) and `port` (0: one that is free). No
  /// other program may use the port. Throws DeviceOpenError: the sentence names address and port,
  /// what the system said, and what to do.
  UdpSocket(const std::string& address, std::uint16_t port);
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  struct Datagram {
    std::size_t size = 0;  ///< of the datagram; larger than the buffer: it was cut
    UdpEndpoint from;
    std::chrono::nanoseconds age{0};  ///< how long it lay in the kernel
  };
  /// Waits until something is there, at most `timeout`. False: nothing. Signals do not cut it
  /// short.
  bool wait(std::chrono::nanoseconds timeout) noexcept;
  /// The oldest datagram that waits; nullopt: none does.
  std::optional<Datagram> receive(std::span<std::byte> buffer) noexcept;
  /// False: the system did not take it.
  bool send(std::span<const std::byte> datagram, const UdpEndpoint& to) noexcept;

  UdpEndpoint local() const noexcept { return local_; }

 private:
  int file_ = -1;
  UdpEndpoint local_;
};

}  // namespace voxtouch::arm
