#pragma once
/// Packets with values derived from each field's published name; decode_fri.py uses the same rule.
#include <string_view>

#include "devices/lwr/fri_codec.hpp"

namespace voxtouch::lwr::fri::test {

inline unsigned base_of(std::string_view name) {
  unsigned sum = 0;
  for (unsigned i = 0; i < name.size(); ++i)
    sum += (i + 1) * static_cast<unsigned char>(name[i]);
  return sum % 4001;
}
template <std::size_t N>
void name(std::array<float, N>& field, std::string_view as) {
  for (std::size_t i = 0; i < N; ++i)
    field[i] = static_cast<float>(base_of(as)) + static_cast<float>(i) / 8.0F;
}
template <std::size_t N>
void name(std::array<std::int32_t, N>& field, std::string_view as) {
  for (std::size_t i = 0; i < N; ++i)
    field[i] = -static_cast<std::int32_t>(base_of(as)) - static_cast<std::int32_t>(i);
}
inline void name(float& field, std::string_view as) { field = static_cast<float>(base_of(as)); }
inline void name(std::uint16_t& field, std::string_view as) {
  field = static_cast<std::uint16_t>(base_of(as));
}
inline void name(std::uint32_t& field, std::string_view as) { field = base_of(as); }

inline void name_common(Header& header, Krl& krl) {
  name(header.send_seq, "sendSeqCount"), name(header.refl_seq, "reflSeqCount");
  name(krl.real, "krlReal"), name(krl.integer, "krlInt"), name(krl.boolean, "krlBool"),
      name(krl.fill, "fill");
}

inline MsrPacket named_msr() {
  MsrPacket p = empty_msr();
  name_common(p.header, p.krl);
  Interface& i = p.interface;
  i.state = State::kCmd, i.quality = Quality::kPerfect;
  name(i.timestamp_s, "timestamp"), name(i.msr_period_s, "desiredMsrSampleTime"),
      name(i.cmd_period_s, "desiredCmdSampleTime");
  name(i.safety_limits, "safetyLimits"), name(i.statistics.answer_rate, "answerRate");
  name(i.statistics.latency_s, "latency"), name(i.statistics.jitter_s, "jitter");
  name(i.statistics.miss_rate, "missRate"), name(i.statistics.miss_counter, "missCounter");
  p.robot.control = Control::kCartesianImpedance;
  name(p.robot.power, "power"), name(p.robot.error, "error"), name(p.robot.warning, "warning");
  name(p.robot.temperature, "temperature");
  Measured& d = p.data;
  name(d.jnt_pos, "msrJntPos"), name(d.cart_pos, "msrCartPos"), name(d.cmd_jnt_pos, "cmdJntPos");
  name(d.cmd_jnt_pos_fri_offset, "cmdJntPosFriOffset"), name(d.cmd_cart_pos, "cmdCartPos");
  name(d.cmd_cart_pos_fri_offset, "cmdCartPosFriOffset"), name(d.jnt_trq, "msrJntTrq");
  name(d.est_ext_jnt_trq, "estExtJntTrq"), name(d.est_ext_tcp_ft, "estExtTcpFT"),
      name(d.jacobian, "jacobian");
  name(d.mass_matrix, "massMatrix"), name(d.gravity, "gravity");
  return p;
}

inline CmdPacket named_cmd() {
  CmdPacket p = empty_cmd();
  name_common(p.header, p.krl);
  Command& c = p.command;
  name(c.cmd_flags, "cmdFlags"), name(c.jnt_pos, "jntPos"), name(c.cart_pos, "cartPos"),
      name(c.add_jnt_trq, "addJntTrq");
  name(c.add_tcp_ft, "addTcpFT"), name(c.jnt_stiffness, "jntStiffness"),
      name(c.jnt_damping, "jntDamping");
  name(c.cart_stiffness, "cartStiffness"), name(c.cart_damping, "cartDamping");
  return p;
}

}  // namespace voxtouch::lwr::fri::test
