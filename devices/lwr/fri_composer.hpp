#pragma once
/// The reply to a measurement: mirrored position, or measured position with additional torque.
#include <cstdint>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/fri_session.hpp"

namespace voxtouch::lwr::fri {

struct ComposerRules {
  double joint_damping = 0.1;  ///< normalised, 0.1 to 1; with zero stiffness it has little effect
  LwrJoints step_limit_rad = LwrJoints::Constant(1e-3);  ///< of the commanded position per reply
};

/// Keeps the send count and the commanded position. Real-time safe.
/// The flags are equal in every packet, so they cannot change outside MON. In command mode the
/// position follows the measured one by at most `step_limit_rad` per reply, so that the difference
/// at the start of command mode causes no jump.
class FriComposer {
 public:
  explicit FriComposer(const ComposerRules& rules) noexcept;

  /// The reply to `msr`. `torque`: joint torque in addition to the arm's gravity compensation [Nm].
  /// If `session` is not in command mode, the position mirrors the controller's command and
  /// `torque` is omitted. `trusted`: the measured position may be followed; otherwise the commanded
  /// one is kept. All numbers in the reply are finite for any input: the last finite one replaces a
  /// non-finite one, without torque.
  const CmdPacket& answer(const MsrPacket& msr, const FriSession& session, bool trusted,
                          const LwrJoints& torque) noexcept;
  /// The reply to a packet with a valid header only: the last position again, no torque.
  const CmdPacket& reply_to_invalid(const Header& header, const FriSession& session) noexcept;
  /// False until the first reply: there is no position to repeat yet.
  bool ready() const noexcept { return ready_; }

 private:
  void head(const Header& header, const FriSession& session) noexcept;
  void place(const MsrPacket& msr, bool in_command, bool trusted) noexcept;

  ComposerRules rules_;
  CmdPacket packet_;
  LwrJoints commanded_ = LwrJoints::Zero();
  std::uint16_t send_seq_ = 0;
  bool ready_ = false;
};

}  // namespace voxtouch::lwr::fri
