#include "devices/lwr/fri_capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace voxtouch::lwr::fri {
namespace {

constexpr std::uint32_t kPcapMagic = 0xA1B2C3D4, kLinkTypeRaw = 101, kSnapLength = 65535;
constexpr std::size_t kIpHeader = 20, kUdpHeader = 8;

void put16(std::byte* at, std::uint32_t value) noexcept {
  at[0] = static_cast<std::byte>(value >> 8 & 255), at[1] = static_cast<std::byte>(value & 255);
}
void put32(std::byte* at, std::uint32_t value) noexcept {
  put16(at, value >> 16), put16(at + 2, value & 0xFFFF);
}

/// One's complement sum of the header's words (RFC 791).
std::uint32_t ip_checksum(std::span<const std::byte, kIpHeader> header) noexcept {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < kIpHeader; i += 2)
    sum += std::to_integer<std::uint32_t>(header[i]) << 8 |
           std::to_integer<std::uint32_t>(header[i + 1]);
  while (sum >> 16)
    sum = (sum & 0xFFFF) + (sum >> 16);
  return ~sum & 0xFFFF;
}

using Headers = std::array<std::byte, kIpHeader + kUdpHeader>;

Headers headers_for(const UdpEndpoint& from, const UdpEndpoint& to,
                    std::uint32_t payload) noexcept {
  Headers h{};
  h[0] = std::byte{0x45};  // version 4, five words
  put16(&h[2], static_cast<std::uint32_t>(h.size()) + payload);
  h[8] = std::byte{64};  // time to live
  h[9] = std::byte{17};  // UDP
  put32(&h[12], from.address);
  put32(&h[16], to.address);
  put16(&h[10], ip_checksum(std::span<const std::byte, kIpHeader>(h.data(), kIpHeader)));
  put16(&h[20], from.port);
  put16(&h[22], to.port);
  put16(&h[24], static_cast<std::uint32_t>(kUdpHeader) + payload);
  return h;
}

template <class T>
void put(std::ofstream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

void FriCapture::note(std::span<const std::byte> datagram, const UdpEndpoint& from,
                      const UdpEndpoint& to, std::int64_t time_ns) noexcept {
  if (ring_.empty())
    return;
  Record& record = ring_[count_++ % ring_.size()];
  record.time_ns = time_ns;
  record.from = from, record.to = to;
  record.original_size = static_cast<std::uint32_t>(datagram.size());
  record.size = static_cast<std::uint32_t>(std::min(datagram.size(), record.bytes.size()));
  std::memcpy(record.bytes.data(), datagram.data(), record.size);
}

void FriCapture::write(const std::string& path) const {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  const std::array<std::uint16_t, 2> version = {2, 4};
  put(file, kPcapMagic);
  put(file, version);
  for (const std::uint32_t word : {0U, 0U, kSnapLength, kLinkTypeRaw})
    put(file, word);
  for (std::uint64_t i = count_ - size(); i < count_; ++i) {
    const Record& record = ring_[i % ring_.size()];
    const Headers headers = headers_for(record.from, record.to, record.original_size);
    const auto bytes = static_cast<std::uint32_t>(headers.size());
    put(file, static_cast<std::uint32_t>(record.time_ns / 1'000'000'000));
    put(file, static_cast<std::uint32_t>(record.time_ns % 1'000'000'000 / 1000));
    put(file, bytes + record.size);
    put(file, bytes + record.original_size);
    put(file, headers);
    file.write(reinterpret_cast<const char*>(record.bytes.data()), record.size);
  }
  file.flush();
  if (!file)
    throw std::runtime_error(fmt::format(
        "cannot write the capture '{}': check the folder and the free disk space", path));
}

}  // namespace voxtouch::lwr::fri
