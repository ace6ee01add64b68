#pragma once
/// Between datagrams, packets and the project's types. Real-time safe throughout: values in, values
/// out.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/types/geometry.hpp"
#include "devices/lwr/fri_packets.hpp"
#include "devices/lwr/lwr_arm.hpp"

namespace voxtouch::lwr::fri {

/// Why a datagram is not the packet that it should be.
enum class PacketFault : std::uint8_t {
  kNone,
  kLength,     ///< the datagram has not the packet's number of bytes
  kId,         ///< header.datagram_id
  kSizeField,  ///< header.packet_size
  kEnum,       ///< state, quality or control has a value that the interface does not define
  kNotFinite,  ///< a number that must be one is not (which: see the function)
};
/// One word, for logs.
std::string_view name_of(PacketFault fault) noexcept;

/// Copies `datagram` to `packet` and checks it. On kLength nothing is copied; after every other
/// fault the packet holds the bytes. A measurement must have a finite time stamp and periods, and a
/// finite position to mirror (`cmd_jnt_pos`, `cmd_jnt_pos_fri_offset`); what was measured is
/// checked apart, by `measured_finite`, since a controller that lost a sensor still has to be
/// answered.
PacketFault decode(std::span<const std::byte> datagram, MsrPacket& packet) noexcept;
/// Every number of a command must be finite.
PacketFault decode(std::span<const std::byte> datagram, CmdPacket& packet) noexcept;
/// The measured joint positions are numbers.
bool measured_finite(const MsrPacket& packet) noexcept;
/// Every float of the command is a number: the last question before the wire.
bool finite(const CmdPacket& packet) noexcept;

/// Header of a packet with size and id filled in, counters zero, all else zero.
MsrPacket empty_msr() noexcept;
/// The same of a command.
CmdPacket empty_cmd() noexcept;

/// How far `to` is ahead of `from` on a counter that wraps: in [-32768, 32767].
constexpr std::int32_t sequence_distance(std::uint16_t from, std::uint16_t to) noexcept {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

// The wire's rotations come in the order Z, Y, X; the project's in X, Y, Z. All six-vectors and
// Jacobians pass through here.
CartVector to_wire(const Vec6& xyz) noexcept;
JacobianRows to_wire(const LwrJacobian& xyz) noexcept;
LwrJoints from_wire(const Joints& wire) noexcept;
/// A double beyond the floats becomes Inf, which `finite` refuses.
Joints to_wire(const LwrJoints& joints) noexcept;
/// [R | p] as floats, p in m.
Frame to_wire(const Pose& pose) noexcept;

}  // namespace voxtouch::lwr::fri
