#pragma once
/// Datagrams that no RTPS stack should send. Message i of a seed is the same in every run, whatever
/// was made before it.
#include <cstdint>
#include <string_view>

#include "tests/attack/network/neighbours.hpp"

namespace voxtouch::attack {

enum class Garbage : std::uint8_t {
  kBytes,      ///< random bytes
  kHeaders,    ///< a good header of none, then submessages of any kind, flags and length
  kDiscovery,  ///< a valid header with an unknown GUID, then discovery and type lookup with random
               ///< parameters
  kSpoofed,    ///< as the two before, under the prefix of a neighbour
  kFlipped,    ///< a neighbour's announcement with some flipped bits
  kGhosts,     ///< participants that are not there: ghost.hpp
};
inline constexpr std::string_view kGarbageNames[] = {"bytes",   "headers", "discovery",
                                                     "spoofed", "flipped", "ghosts"};

/// Mostly at most 1472 bytes, rarely up to 65507. Without a neighbour `spoofed` and `flipped` equal
/// `headers`, and ghosts are empty.
Bytes make_garbage(Garbage kind, std::uint64_t seed, std::uint64_t i, const Neighbours& neighbours);

}  // namespace voxtouch::attack
