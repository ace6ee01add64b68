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
  kDiscovery,  ///< a good header of none, then what discovery and type lookup are sent by, with
               ///< random parameters
  kSpoofed,    ///< as the two before, under the prefix of a neighbour
  kFlipped,    ///< a neighbour's announcement with some bits turned
  kGhosts,     ///< participants that are not there: ghost.hpp
};
inline constexpr std::string_view kGarbageNames[] = {"bytes",   "headers", "discovery",
                                                     "spoofed", "flipped", "ghosts"};

/// At most 1472 bytes mostly, rarely up to 65507. `spoofed` and `flipped` are `headers` where there
/// is no neighbour, ghosts are empty.
Bytes make_garbage(Garbage kind, std::uint64_t seed, std::uint64_t i, const Neighbours& neighbours);

}  // namespace voxtouch::attack
