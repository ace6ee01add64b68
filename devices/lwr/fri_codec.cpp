#include "devices/lwr/fri_codec.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/types/enum_name.hpp"

namespace voxtouch::lwr::fri {
namespace {

constexpr std::array<int, 6> kOrder = {0, 1, 2, 5, 4, 3};  // its own inverse

/// Numbers in the row order of a packet.
template <int kRows, int kColumns>
using WireRows =
    Eigen::Matrix<float, kRows, kColumns, kColumns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

template <std::size_t N>
bool all_finite(const std::array<float, N>& values) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [](float value) { return std::isfinite(value); });
}

/// Whether the sum that a reply mirrors outside command mode is finite.
bool mirror_finite(const Measured& data) noexcept {
  for (std::size_t i = 0; i < kJoints; ++i)
    if (!std::isfinite(data.cmd_jnt_pos[i] + data.cmd_jnt_pos_fri_offset[i]))
      return false;
  return true;
}

PacketFault check_header(const Header& header, std::uint16_t id, std::uint16_t size) noexcept {
  if (header.datagram_id != id)
    return PacketFault::kId;
  if (header.packet_size != size)
    return PacketFault::kSizeField;
  return PacketFault::kNone;
}

bool known(State state) noexcept { return state <= State::kCmd || state == State::kInvalid; }
bool known(Quality quality) noexcept {
  return quality <= Quality::kPerfect || quality == Quality::kInvalid;
}
bool known(Control control) noexcept { return control <= Control::kJointImpedance; }

}  // namespace

std::string_view name_of(PacketFault fault) noexcept {
  constexpr std::array<std::string_view, 6> kNames{
      "none",      "length", "datagram id", "size field", "undefined state, quality or control",
      "not finite"};
  return name_in(kNames, fault);
}

PacketFault decode(std::span<const std::byte> datagram, MsrPacket& packet) noexcept {
  if (datagram.size() != kMsrSize)
    return PacketFault::kLength;
  std::memcpy(&packet, datagram.data(), kMsrSize);
  if (const PacketFault fault = check_header(packet.header, kMsrId, kMsrSize);
      fault != PacketFault::kNone)
    return fault;
  const Interface& intf = packet.interface;
  if (!known(intf.state) || !known(intf.quality) || !known(packet.robot.control))
    return PacketFault::kEnum;
  const bool timed = std::isfinite(intf.timestamp_s) && std::isfinite(intf.msr_period_s) &&
                     std::isfinite(intf.cmd_period_s);
  return timed && mirror_finite(packet.data) ? PacketFault::kNone : PacketFault::kNotFinite;
}

PacketFault decode(std::span<const std::byte> datagram, CmdPacket& packet) noexcept {
  if (datagram.size() != kCmdSize)
    return PacketFault::kLength;
  std::memcpy(&packet, datagram.data(), kCmdSize);
  if (const PacketFault fault = check_header(packet.header, kCmdId, kCmdSize);
      fault != PacketFault::kNone)
    return fault;
  return finite(packet) ? PacketFault::kNone : PacketFault::kNotFinite;
}

bool measured_finite(const MsrPacket& packet) noexcept { return all_finite(packet.data.jnt_pos); }

bool finite(const CmdPacket& packet) noexcept {
  const Command& c = packet.command;
  return all_finite(packet.krl.real) && all_finite(c.jnt_pos) && all_finite(c.cart_pos) &&
         all_finite(c.add_jnt_trq) && all_finite(c.add_tcp_ft) && all_finite(c.jnt_stiffness) &&
         all_finite(c.jnt_damping) && all_finite(c.cart_stiffness) && all_finite(c.cart_damping);
}

MsrPacket empty_msr() noexcept {
  MsrPacket packet{};
  packet.header = {.send_seq = 0, .refl_seq = 0, .packet_size = kMsrSize, .datagram_id = kMsrId};
  return packet;
}

CmdPacket empty_cmd() noexcept {
  CmdPacket packet{};
  packet.header = {.send_seq = 0, .refl_seq = 0, .packet_size = kCmdSize, .datagram_id = kCmdId};
  return packet;
}

CartVector to_wire(const Vec6& xyz) noexcept {
  CartVector wire;
  Eigen::Map<WireRows<6, 1>>(wire.data()) = xyz(kOrder).cast<float>();
  return wire;
}

JacobianRows to_wire(const LwrJacobian& xyz) noexcept {
  JacobianRows wire;
  Eigen::Map<WireRows<6, 7>>(wire.data()) = xyz(kOrder, Eigen::all).cast<float>();
  return wire;
}

LwrJoints from_wire(const Joints& wire) noexcept {
  return Eigen::Map<const WireRows<7, 1>>(wire.data()).cast<double>();
}

Joints to_wire(const LwrJoints& joints) noexcept {
  Joints wire;
  Eigen::Map<WireRows<7, 1>>(wire.data()) = joints.cast<float>();
  return wire;
}

Frame to_wire(const Pose& pose) noexcept {
  Frame wire;
  Eigen::Map<WireRows<3, 4>> rows(wire.data());
  rows.leftCols<3>() = pose.orientation.toRotationMatrix().cast<float>();
  rows.col(3) = pose.position.cast<float>();
  return wire;
}

}  // namespace voxtouch::lwr::fri
