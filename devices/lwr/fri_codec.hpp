#pragma once
/// Converts between datagrams, packets and the types of the project. All functions are real-time
/// safe and have no state.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/types/geometry.hpp"
#include "devices/lwr/fri_packets.hpp"
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr::fri {

/// Why a datagram is not the expected packet.
enum class PacketFault : std::uint8_t {
  kNone,
  kLength,     ///< the size of the datagram is not that of the packet
  kId,         ///< header.datagram_id
  kSizeField,  ///< header.packet_size
  kEnum,       ///< state, quality or control has an undefined value
  kNotFinite,  ///< a required number is not finite (see the function)
};
/// A phrase for messages.
std::string_view name_of(PacketFault fault) noexcept;

/// Copies `datagram` to `packet` and checks it. On kLength nothing is copied; after other faults
/// the packet contains the bytes. A measurement must have a finite time stamp, periods and position
/// to mirror (`cmd_jnt_pos`, `cmd_jnt_pos_fri_offset`). `measured_finite` checks the measured
/// values separately, since a controller that lost a sensor must still be answered.
PacketFault decode(std::span<const std::byte> datagram, MsrPacket& packet) noexcept;
/// Every number of a command must be finite.
PacketFault decode(std::span<const std::byte> datagram, CmdPacket& packet) noexcept;
/// Whether the measured joint positions are finite.
bool measured_finite(const MsrPacket& packet) noexcept;
/// Whether every float of the command is finite: the last check at sending.
bool finite(const CmdPacket& packet) noexcept;

/// A packet with size and id filled in, and all other fields zero.
MsrPacket empty_msr() noexcept;
/// The same for a command.
CmdPacket empty_cmd() noexcept;

/// Distance from `from` to `to` on a counter that wraps: in [-32768, 32767].
constexpr std::int32_t sequence_distance(std::uint16_t from, std::uint16_t to) noexcept {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

// Rotations on the wire are in the order Z, Y, X; those of the project in X, Y, Z. All six-vectors
// and Jacobians are converted here.
CartVector to_wire(const Vec6& xyz) noexcept;
JacobianRows to_wire(const LwrJacobian& xyz) noexcept;
LwrJoints from_wire(const Joints& wire) noexcept;
/// A double beyond the float range becomes Inf, which `finite` refuses.
Joints to_wire(const LwrJoints& joints) noexcept;
/// [R | p] as floats, p in m.
Frame to_wire(const Pose& pose) noexcept;

}  // namespace voxtouch::lwr::fri
