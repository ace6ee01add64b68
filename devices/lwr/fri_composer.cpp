#include "devices/lwr/fri_composer.hpp"

#include <algorithm>
#include <cmath>

namespace voxtouch::fri {
namespace {

constexpr std::uint32_t kJointFlags = kFlagJntPos | kFlagJntTrq | kFlagJntStiff | kFlagJntDamp;
constexpr std::uint32_t kCartFlags = kFlagCartPos | kFlagTcpFt | kFlagCartStiff | kFlagCartDamp | kFlagJntPos;

bool all_finite(const Frame& frame) noexcept {
  return std::all_of(frame.begin(), frame.end(), [](float value) { return std::isfinite(value); });
}

}  // namespace

FriComposer::FriComposer(const ComposerRules& rules) noexcept : rules_(rules), packet_(empty_cmd()) {
  Command& c = packet_.command;
  const bool cartesian = rules.strategy == Strategy::kCartesianImpedance;
  c.cmd_flags = cartesian ? kCartFlags : kJointFlags;
  c.cart_pos = to_wire(Pose{});
  c.jnt_damping.fill(static_cast<float>(rules.joint_damping));  // jnt_stiffness stays zero
  Vec6 stiffness;
  stiffness << Vec3::Constant(rules.cart_stiffness_n_per_m), Vec3::Constant(rules.cart_stiffness_nm_per_rad);
  c.cart_stiffness = to_wire(stiffness);
  c.cart_damping.fill(static_cast<float>(rules.cart_damping));
}

void FriComposer::head(const Header& header, const FriSession& session) noexcept {
  packet_.header.send_seq = ++send_seq_;
  packet_.header.refl_seq = header.send_seq;
  session.fill(packet_.krl);
}

void FriComposer::relax() noexcept {
  packet_.command.add_jnt_trq.fill(0.0F);
  packet_.command.add_tcp_ft.fill(0.0F);
}

void FriComposer::place(const MsrPacket& msr, bool in_command, bool trusted) noexcept {
  if (!in_command) {
    commanded_ = from_wire(msr.data.cmd_jnt_pos) + from_wire(msr.data.cmd_jnt_pos_fri_offset);
  } else if (trusted) {
    const LwrJoints goal =
        rules_.strategy == Strategy::kCartesianImpedance ? rules_.posture : from_wire(msr.data.jnt_pos);
    commanded_ += (goal - commanded_).cwiseMax(-rules_.step_limit_rad).cwiseMin(rules_.step_limit_rad);
  }
  packet_.command.jnt_pos = to_wire(commanded_);
  if (all_finite(msr.data.cart_pos)) packet_.command.cart_pos = msr.data.cart_pos;
}

void FriComposer::push_with(const Push& push) noexcept {
  if (rules_.strategy != Strategy::kCartesianImpedance) {
    packet_.command.add_jnt_trq = to_wire(push.add_torque);
    return;
  }
  const Quat turn = rules_.task_frame == TaskFrame::kTool ? push.tool_in_base.conjugate() : Quat::Identity();
  Vec6 wrench;
  wrench << turn * push.wrench.force, turn * push.wrench.torque;
  packet_.command.add_tcp_ft = to_wire(wrench);
}

const CmdPacket& FriComposer::answer(const MsrPacket& msr, const FriSession& session, bool trusted,
                                     const Push& push) noexcept {
  head(msr.header, session);
  relax();
  place(msr, session.in_command(), trusted);
  ready_ = true;
  if (session.in_command() && session.force_allowed()) push_with(push);
  if (!finite(packet_)) relax();
  return packet_;
}

const CmdPacket& FriComposer::answer_untrusted(const Header& header, const FriSession& session) noexcept {
  head(header, session);
  relax();
  return packet_;
}

}  // namespace voxtouch::fri
