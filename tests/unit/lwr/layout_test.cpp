// The layout of the packets, field by field: that this file compiles is the test.
#include <cstddef>

#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr::fri {
namespace {

#define VOXTOUCH_FRI_AT(packet, field, offset) \
  static_assert(offsetof(packet, field) == (offset), #field)
VOXTOUCH_FRI_AT(MsrPacket, header.send_seq, 0);
VOXTOUCH_FRI_AT(MsrPacket, header.refl_seq, 2);
VOXTOUCH_FRI_AT(MsrPacket, header.packet_size, 4);
VOXTOUCH_FRI_AT(MsrPacket, header.datagram_id, 6);
VOXTOUCH_FRI_AT(MsrPacket, krl.real, 8);
VOXTOUCH_FRI_AT(MsrPacket, krl.integer, 72);
VOXTOUCH_FRI_AT(MsrPacket, krl.boolean, 136);
VOXTOUCH_FRI_AT(MsrPacket, krl.fill, 138);
VOXTOUCH_FRI_AT(MsrPacket, interface.timestamp_s, 140);
VOXTOUCH_FRI_AT(MsrPacket, interface.state, 144);
VOXTOUCH_FRI_AT(MsrPacket, interface.quality, 146);
VOXTOUCH_FRI_AT(MsrPacket, interface.msr_period_s, 148);
VOXTOUCH_FRI_AT(MsrPacket, interface.cmd_period_s, 152);
VOXTOUCH_FRI_AT(MsrPacket, interface.safety_limits, 156);
VOXTOUCH_FRI_AT(MsrPacket, interface.statistics.answer_rate, 160);
VOXTOUCH_FRI_AT(MsrPacket, interface.statistics.latency_s, 164);
VOXTOUCH_FRI_AT(MsrPacket, interface.statistics.jitter_s, 168);
VOXTOUCH_FRI_AT(MsrPacket, interface.statistics.miss_rate, 172);
VOXTOUCH_FRI_AT(MsrPacket, interface.statistics.miss_counter, 176);
VOXTOUCH_FRI_AT(MsrPacket, robot.power, 180);
VOXTOUCH_FRI_AT(MsrPacket, robot.control, 182);
VOXTOUCH_FRI_AT(MsrPacket, robot.error, 184);
VOXTOUCH_FRI_AT(MsrPacket, robot.warning, 186);
VOXTOUCH_FRI_AT(MsrPacket, robot.temperature, 188);
VOXTOUCH_FRI_AT(MsrPacket, data.jnt_pos, 216);
VOXTOUCH_FRI_AT(MsrPacket, data.cart_pos, 244);
VOXTOUCH_FRI_AT(MsrPacket, data.cmd_jnt_pos, 292);
VOXTOUCH_FRI_AT(MsrPacket, data.cmd_jnt_pos_fri_offset, 320);
VOXTOUCH_FRI_AT(MsrPacket, data.cmd_cart_pos, 348);
VOXTOUCH_FRI_AT(MsrPacket, data.cmd_cart_pos_fri_offset, 396);
VOXTOUCH_FRI_AT(MsrPacket, data.jnt_trq, 444);
VOXTOUCH_FRI_AT(MsrPacket, data.est_ext_jnt_trq, 472);
VOXTOUCH_FRI_AT(MsrPacket, data.est_ext_tcp_ft, 500);
VOXTOUCH_FRI_AT(MsrPacket, data.jacobian, 524);
VOXTOUCH_FRI_AT(MsrPacket, data.mass_matrix, 692);
VOXTOUCH_FRI_AT(MsrPacket, data.gravity, 888);
VOXTOUCH_FRI_AT(CmdPacket, header.send_seq, 0);
VOXTOUCH_FRI_AT(CmdPacket, header.refl_seq, 2);
VOXTOUCH_FRI_AT(CmdPacket, header.packet_size, 4);
VOXTOUCH_FRI_AT(CmdPacket, header.datagram_id, 6);
VOXTOUCH_FRI_AT(CmdPacket, krl.real, 8);
VOXTOUCH_FRI_AT(CmdPacket, krl.integer, 72);
VOXTOUCH_FRI_AT(CmdPacket, krl.boolean, 136);
VOXTOUCH_FRI_AT(CmdPacket, krl.fill, 138);
VOXTOUCH_FRI_AT(CmdPacket, command.cmd_flags, 140);
VOXTOUCH_FRI_AT(CmdPacket, command.jnt_pos, 144);
VOXTOUCH_FRI_AT(CmdPacket, command.cart_pos, 172);
VOXTOUCH_FRI_AT(CmdPacket, command.add_jnt_trq, 220);
VOXTOUCH_FRI_AT(CmdPacket, command.add_tcp_ft, 248);
VOXTOUCH_FRI_AT(CmdPacket, command.jnt_stiffness, 272);
VOXTOUCH_FRI_AT(CmdPacket, command.jnt_damping, 300);
VOXTOUCH_FRI_AT(CmdPacket, command.cart_stiffness, 328);
VOXTOUCH_FRI_AT(CmdPacket, command.cart_damping, 352);
#undef VOXTOUCH_FRI_AT

}  // namespace
}  // namespace voxtouch::lwr::fri
