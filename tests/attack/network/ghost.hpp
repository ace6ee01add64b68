#pragma once
/// A participant that is not there: announced as a neighbour is, matched by the ring's endpoints,
/// and then sending what it likes. Its messages reach what reads types, policies and samples, which
/// garbage without an announcement does not.
#include <cstdint>

#include "tests/attack/network/neighbours.hpp"

namespace voxtouch::attack {

inline constexpr std::uint64_t kGhostSteps =
    16;  ///< messages of one ghost, to be sent in order to one port

/// Message `step` of ghost `ghost`: its announcement, writers and readers on topics of the rig
/// `haptic`, samples of random bytes, then type lookup, heartbeats, gaps and fragments. Empty where
/// there is no neighbour whose announcement it could take.
Bytes make_ghost(std::uint64_t seed, std::uint64_t ghost, std::uint64_t step,
                 const Neighbours& neighbours);

}  // namespace voxtouch::attack
