#pragma once
/// The answer to a measurement: mirrored position, or measured position with torque on top.
#include <cstdint>

#include "devices/lwr/fri_codec.hpp"
#include "devices/lwr/fri_session.hpp"

namespace voxtouch::lwr::fri {

struct ComposerRules {
  double joint_damping = 0.1;  ///< normalised, 0.1 to 1; with zero stiffness it does little
  LwrJoints step_limit_rad = LwrJoints::Constant(1e-3);  ///< of the commanded position per answer
};

/// Keeps the send count and the commanded position. Real-time safe.
///
/// The flags are the same in every packet, so they cannot change outside MON. In command mode the
/// position follows the measured one by at most `step_limit_rad` an answer, so that what is left
/// between commanded and measured position at the start of command mode is no jump.
class FriComposer {
 public:
  explicit FriComposer(const ComposerRules& rules) noexcept;

  /// The answer to `msr`. `push`: torque of the joints on top of the arm's own gravity compensation
  /// [Nm]. While `session` is not in command mode the position mirrors the controller's own command
  /// and `push` is left out. `trusted`: the measured position may be followed; otherwise the
  /// commanded one stays where it is. Every number in it is finite, whatever came in: what is not
  /// is replaced by the last that was, without push.
  const CmdPacket& answer(const MsrPacket& msr, const FriSession& session, bool trusted,
                          const LwrJoints& push) noexcept;
  /// The answer to a packet that cannot be trusted beyond its header: the last position again, no
  /// push.
  const CmdPacket& reply_to_invalid(const Header& header, const FriSession& session) noexcept;
  /// False until one answer was composed: there is no position to repeat yet.
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
