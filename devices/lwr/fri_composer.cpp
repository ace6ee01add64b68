#include "devices/lwr/fri_composer.hpp"

namespace voxtouch::lwr::fri {
namespace {

constexpr std::uint32_t kJointFlags = kFlagJntPos | kFlagJntTrq | kFlagJntStiff | kFlagJntDamp;

}  // namespace

FriComposer::FriComposer(const ComposerRules& rules) noexcept
    : rules_(rules),
      packet_(empty_cmd()) {
  packet_.command.cmd_flags = kJointFlags;
  // jnt_stiffness stays zero.
  packet_.command.jnt_damping.fill(static_cast<float>(rules.joint_damping));
}

void FriComposer::head(const Header& header, const FriSession& session) noexcept {
  packet_.header.send_seq = ++send_seq_;
  packet_.header.refl_seq = header.send_seq;
  session.fill(packet_.krl);
  packet_.command.add_jnt_trq.fill(0.0F);
}

void FriComposer::place(const MsrPacket& msr, bool in_command, bool trusted) noexcept {
  if (!in_command) {
    commanded_ = from_wire(msr.data.cmd_jnt_pos) + from_wire(msr.data.cmd_jnt_pos_fri_offset);
  } else if (trusted) {
    const LwrJoints displacement = from_wire(msr.data.jnt_pos) - commanded_;
    commanded_ += displacement.cwiseMax(-rules_.step_limit_rad).cwiseMin(rules_.step_limit_rad);
  }
  packet_.command.jnt_pos = to_wire(commanded_);
}

const CmdPacket& FriComposer::answer(const MsrPacket& msr, const FriSession& session, bool trusted,
                                     const LwrJoints& torque) noexcept {
  head(msr.header, session);
  place(msr, session.in_command(), trusted);
  ready_ = true;
  if (session.in_command() && session.force_allowed())
    packet_.command.add_jnt_trq = to_wire(torque);
  if (!finite(packet_))
    packet_.command.add_jnt_trq.fill(0.0F);
  return packet_;
}

const CmdPacket& FriComposer::reply_to_invalid(const Header& header,
                                               const FriSession& session) noexcept {
  head(header, session);
  return packet_;
}

}  // namespace voxtouch::lwr::fri
