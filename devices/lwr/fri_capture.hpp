#pragma once
/// The last packets of a session, kept in memory while the loop runs and written to a file that
/// Wireshark opens.
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

/// A ring of datagrams. `note` is real-time safe; the rest allocates.
class FriCapture {
 public:
  /// Room for `packets` datagrams; 0 keeps nothing.
  explicit FriCapture(std::size_t packets = 0) : ring_(packets) {}

  /// Keeps one datagram (what is over the size of a measurement is cut), the oldest one goes.
  void note(std::span<const std::byte> datagram, const UdpEndpoint& from, const UdpEndpoint& to,
            std::int64_t time_ns) noexcept;

  /// Writes what is there, oldest first: classic pcap with microseconds, link type RAW (101), each
  /// record an IPv4 and a UDP header (made here, UDP checksum 0 = none) and the datagram as it was
  /// on the wire. Throws std::runtime_error that names the file.
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
