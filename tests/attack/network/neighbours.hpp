#pragma once
/// Participants of a DDS domain on loopback, from their announcements (RTPS participant discovery).
#include <array>
#include <chrono>
#include <cstdint>
#include <set>
#include <vector>

namespace voxtouch::attack {

using GuidPrefix = std::array<std::uint8_t, 12>;
using Bytes = std::vector<std::uint8_t>;

inline constexpr std::uint8_t kData =
    0x15;  ///< the submessage that carries a sample, also one of discovery

struct Neighbours {
  std::set<GuidPrefix> prefixes;
  std::set<std::uint16_t> ports;     ///< their receiving ports on loopback
  std::vector<Bytes> announcements;  ///< one of each participant, as sent
};

/// Port of the domain that all its participants listen on (RTPS 2.2, 9.6.1.1).
constexpr std::uint16_t discovery_port(std::uint32_t domain) {
  return static_cast<std::uint16_t>(7400 + 250 * domain);
}

/// Listens for `time`. Sends nothing. \throws std::runtime_error if the port cannot be opened.
Neighbours listen_for_neighbours(std::uint32_t domain, std::chrono::milliseconds time);

}  // namespace voxtouch::attack
