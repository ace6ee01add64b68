#pragma once
/// Keeps the last packets of a session in memory, and writes them to a file for Wireshark.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "devices/arm/udp_socket.hpp"
#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr {

using arm::parse_ipv4;
using arm::UdpEndpoint;
using arm::UdpSocket;

namespace fri {

/// A ring of datagrams. `note` is real-time safe; the other functions allocate.
class FriCapture {
 public:
  /// Room for `packets` datagrams; 0 disables it.
  explicit FriCapture(std::size_t packets = 0) : ring_(packets) {}

  /// Stores one datagram in place of the oldest, cut to the size of a measurement.
  void note(std::span<const std::byte> datagram, const UdpEndpoint& from, const UdpEndpoint& to,
            std::int64_t time_ns) noexcept;

  /// Writes the datagrams, oldest first, as classic pcap with microseconds and link type RAW (101).
  /// Each record has a generated IPv4 and UDP header (UDP checksum 0 = none) and the datagram as on
  /// the wire. Throws std::runtime_error that names the file.
  void write(const std::string& path) const;
  std::size_t size() const noexcept {
    return count_ < ring_.size() ? static_cast<std::size_t>(count_) : ring_.size();
  }

 private:
  struct Record {
    std::int64_t time_ns;
    UdpEndpoint from, to;
    std::uint32_t size, original_size;
    std::array<std::byte, kMsrSize> bytes;
  };
  std::vector<Record> ring_;
  std::uint64_t count_ = 0;
};

}  // namespace fri
}  // namespace voxtouch::lwr
