#pragma once
/// Where the robot and this driver are with each other: which mode, which request next, what keeps
/// the force off. No socket, no clock.
#include <cstdint>
#include <optional>
#include <string>

#include "devices/driver.hpp"
#include "devices/fr3/fci_codec.hpp"

namespace voxtouch::fr3::fci {

struct SessionRules {
  double pause_s = 0.5;  ///< after a motion that ended by itself, before the next is asked for
  double start_timeout_s = 2.0;  ///< from Move to the first state in torque control
  double user_stop_timeout_s =
      2.0;  ///< a user stop that lasts ends the session: a person is at work
  int most_restarts = 10;
};

enum class Diagnostic : std::uint8_t {
  kNone,
  kStarting,  ///< Move was asked for
  kRecovering,
  kLostPackets,  ///< a reflex: 20 commands in a row came late or not at all
  kTorqueJump,   ///< a reflex: torques changed faster than the robot bears, as lost commands make
                 ///< them
  kReflex,       ///< another reflex
  kUserStop,
  kGuiding,
  kNotReady,  ///< joints locked, FCI not activated, or busy
  kRefused,   ///< Move or a recovery was refused
  kEnded,     ///< the motion ended without a reason
  kTooOften,
  kFast,  ///< a joint is faster than it may be
};
/// What it is and what to do, for people.
std::string_view sentence_of(Diagnostic diagnostic) noexcept;

/// Torque control is asked for while the robot is idle, and again after what lost packets did;
/// every other reflex is a person's matter. Pure, real-time safe.
class FciSession {
 public:
  explicit FciSession(const Dialect& dialect, const SessionRules& rules = {}) noexcept
      : dialect_(&dialect),
        rules_(rules) {}

  /// A state, `elapsed_s` after the last one. `fast`: a joint is over its speed.
  void see(const State& state, double elapsed_s, bool fast) noexcept;
  /// The answer to a request of this session.
  void answered(Request request, Outcome outcome) noexcept;
  /// The request that is due now; asked once.
  std::optional<Request> due() noexcept;
  /// From now on nothing is asked for but the end of a motion that runs.
  void end() noexcept;

  /// Torque may be commanded.
  bool force_allowed() const noexcept {
    return phase_ == Phase::kRunning && diagnostic_ == Diagnostic::kNone;
  }
  /// The robot waits for commands, pushing or not.
  bool listens() const noexcept { return in_torque_control_; }
  /// kRecoverable as long as it may get better by itself or by a person; kFault: over.
  devices::DeviceError error() const noexcept {
    return phase_ == Phase::kFailed ? devices::DeviceError::kFault
                                    : devices::DeviceError::kRecoverable;
  }
  Diagnostic diagnostic() const noexcept { return diagnostic_; }
  Errors errors() const noexcept { return errors_; }  ///< of the diagnostic, if a reflex
  Outcome refusal() const noexcept { return refusal_; }
  int restarts() const noexcept { return restarts_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kStarting, kRunning, kRecovering, kEnding, kFailed };
  void wait(Diagnostic diagnostic) noexcept;
  void fail(Diagnostic diagnostic) noexcept;
  void ask(Request request, Phase phase, Diagnostic diagnostic) noexcept;
  void see_idle() noexcept;
  void see_reflex(const State& state) noexcept;

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
