#pragma once
/// State machine of the session between robot and driver: mode, next request, and reason for zero
/// force. It uses no socket and no clock.
#include <cstdint>
#include <optional>
#include <string>

#include "devices/driver.hpp"
#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3::fci {

struct SessionRules {
  double pause_s = 0.5;          ///< after a motion ended by the robot, until the next request
  double start_timeout_s = 2.0;  ///< from Move to the first state in torque control
  /// A longer user stop ends the session: the operator is working at the robot.
  double user_stop_timeout_s = 2.0;
  int most_restarts = 10;
};

enum class Diagnostic : std::uint8_t {
  kNone,
  kStarting,  ///< Move was requested
  kRecovering,
  kLostPackets,  ///< a reflex: 20 consecutive commands were late or missing
  /// A reflex: torques changed faster than the robot allows, an effect of lost commands.
  kTorqueJump,
  kReflex,  ///< another reflex
  kUserStop,
  kGuiding,
  kNotReady,  ///< joints locked, FCI not activated, or busy
  kRefused,   ///< Move or a recovery was refused
  kEnded,     ///< the motion ended without a reason
  kTooOften,
  kFast,  ///< a joint exceeds its speed limit
};
/// Describes the diagnostic and the remedy.
std::string_view sentence_of(Diagnostic diagnostic) noexcept;

/// Requests torque control while the robot is idle, and again after an effect of lost packets; any
/// other reflex requires the operator. A pure function of its inputs, real-time safe.
class FciSession {
 public:
  explicit FciSession(const Dialect& dialect, const SessionRules& rules = {}) noexcept
      : dialect_(&dialect),
        rules_(rules) {}

  /// Processes a state, `elapsed_s` after the last one. `fast`: a joint exceeds its speed limit.
  void update(const State& state, double elapsed_s, bool fast) noexcept;
  /// Processes the reply to a request of this session.
  void answered(Request request, Outcome outcome) noexcept;
  /// The request that is due, returned once.
  std::optional<Request> due() noexcept;
  /// From now on the only request is the end of a running motion.
  void end() noexcept;

  /// Torque may be commanded.
  bool force_allowed() const noexcept {
    return phase_ == Phase::kRunning && diagnostic_ == Diagnostic::kNone;
  }
  /// The robot expects commands, with or without force.
  bool listens() const noexcept { return in_torque_control_; }
  /// kRecoverable while it may recover by itself or by the operator; kFault: the session is over.
  devices::DeviceError error() const noexcept {
    return phase_ == Phase::kFailed ? devices::DeviceError::kFault
                                    : devices::DeviceError::kRecoverable;
  }
  Diagnostic diagnostic() const noexcept { return diagnostic_; }
  Errors errors() const noexcept { return errors_; }  ///< of the diagnostic, for a reflex
  Outcome refusal() const noexcept { return refusal_; }
  int restarts() const noexcept { return restarts_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kStarting, kRunning, kRecovering, kEnding, kFailed };
  void wait(Diagnostic diagnostic) noexcept;
  void fail(Diagnostic diagnostic) noexcept;
  void ask(Request request, Phase phase, Diagnostic diagnostic) noexcept;
  void update_idle() noexcept;
  void update_reflex(const State& state) noexcept;

  const Dialect* dialect_;
  SessionRules rules_;
  Phase phase_ = Phase::kWaiting;
  Diagnostic diagnostic_ = Diagnostic::kStarting;
  Errors errors_ = 0;
  Outcome refusal_ = Outcome::kSuccess;
  std::optional<Request> due_;
  double waited_s_ = 1e9;  // the first Move is due at once
  double stopped_s_ = 0.0;
  int restarts_ = 0;
  bool in_torque_control_ = false;
};

}  // namespace voxtouch::fr3::fci
