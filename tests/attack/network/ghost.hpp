#pragma once
/// A participant that does not exist: announced like a neighbour, matched by the ring's endpoints,
/// then sending arbitrary data. Its messages reach the readers of types, policies and samples,
/// unlike garbage without an announcement.
#include <cstdint>

#include "tests/attack/network/neighbours.hpp"

namespace voxtouch::attack {

inline constexpr std::uint64_t kGhostSteps =
    16;  ///< messages of one ghost, to be sent in order to one port

/// Message `step` of ghost `ghost`: its announcement, writers and readers on topics of the rig
/// `haptic`, samples of random bytes, then type lookup, heartbeats, gaps and fragments. Empty
/// without a neighbour to copy the announcement of.
Bytes make_ghost(std::uint64_t seed, std::uint64_t ghost, std::uint64_t step,
                 const Neighbours& neighbours);

}  // namespace voxtouch::attack
