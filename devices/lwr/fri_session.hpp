#pragma once
/// From the first packet to command mode and back: the handshake with the KRL program, and what
/// stands in the way of force.
#include <cstdint>
#include <string>
#include <string_view>

#include "devices/driver.hpp"
#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr::fri {

/// What keeps the force off. Each has a sentence.
enum class Diagnostic : std::uint8_t {
  kNone,
  kQualityTooLowToStart,
  kDrivesNotOn,       ///< not yet, since the program started
  kDrivesWentOff,     ///< emergency stop, enabling switch, or a stop by the controller
  kDriveError,        ///< error bits
  kProgramStillRuns,  ///< the KRL program has not followed the request to stop
  kStarting,          ///< asked for command mode, not there yet
  kStartTimedOut,
  kDroppedOut,  ///< the controller left command mode by itself
  kTooManyDrops,
  kQualityDropped,    ///< in command mode
  kWrongControlMode,  ///< in command mode, but not with the strategy asked for
  kTooFast,           ///< a joint over its speed limit
  kClosed,            ///< friClose, or the state is none
  kStopping,
};
/// What happened and what to do, one sentence. Real-time safe.
std::string_view sentence_of(Diagnostic diagnostic) noexcept;
/// What a caller can do about it; kRecoverable for kNone.
devices::DeviceError error_of(Diagnostic diagnostic) noexcept;

struct SessionRules {
  Quality start_quality = Quality::kPerfect;  ///< friStart is asked for from here on
  Quality keep_quality = Quality::kOk;        ///< in command mode force needs at least this
  double start_timeout_s = 5.0;               ///< from the request to command mode
  double pause_s = 0.5;  ///< after leaving command mode or a failed start, before the next request
  double drives_off_grace_s = 2.0;  ///< drives that went off this long are a fault
  std::uint32_t max_drops = 10;     ///< after this many the person is asked
};

/// Pure: measurements in, requests out. Real-time safe.
///
/// Each request is a state of the KRL variable $FRI_FRM_INT[2], which the program echoes in
/// $FRI_TO_INT[2]:
///   kHalting   0 is asked for. Left in MON, drives on, with an echo that is not 1 (a program still
///   in the run of an earlier driver
///              is thus halted first), after the pause.
///   kWaiting   still 0: the quality has to come up.
///   kStarting  1 is asked for: the program calls friStart.
///   kRunning   command mode; force may flow.
class FriSession {
 public:
  enum class Phase : std::uint8_t { kHalting, kWaiting, kStarting, kRunning };
  explicit FriSession(const SessionRules& rules) noexcept : rules_(rules), pause_left_s_(0.0) {}

  /// One new measurement, `elapsed_s` after the one before. `arm`: what the arm's geometry says
  /// about it (kNone, kTooFast).
  void see(const MsrPacket& msr, double elapsed_s, Diagnostic arm) noexcept;
  /// For good: 0 is asked for, force is off.
  void request_stop() noexcept;
  /// The stop has been followed: the controller is in no command mode, and the program has received
  /// the request.
  bool stopped() const noexcept { return stopping_ && !in_command_ && !echo_runs_; }

  /// The controller acts on what the command says (CMD, drives on), so the position must be our
  /// own; otherwise it must mirror.
  bool in_command() const noexcept { return in_command_; }
  bool force_allowed() const noexcept { return diagnostic_ == Diagnostic::kNone; }
  Diagnostic diagnostic() const noexcept { return diagnostic_; }
  /// error_of the diagnostic; drives that stay off for longer than the grace become a fault.
  devices::DeviceError error() const noexcept;
  Phase phase() const noexcept { return phase_; }
  /// Fills the program's variables: strategy and request.
  void fill(Krl& krl) const noexcept;

  std::uint32_t starts() const noexcept { return starts_; }  ///< times command mode was reached
  std::uint32_t drops() const noexcept { return drops_; }  ///< times the controller left it unasked

 private:
  void advance(const MsrPacket& msr) noexcept;
  void halt(Diagnostic why, double pause_s) noexcept;
  Diagnostic drives(const MsrPacket& msr, double elapsed_s) noexcept;
  Diagnostic judge(const MsrPacket& msr, Diagnostic arm) const noexcept;

  SessionRules rules_;
  Phase phase_ = Phase::kHalting;
  Diagnostic diagnostic_ = Diagnostic::kProgramStillRuns;
  Diagnostic halted_by_ = Diagnostic::kProgramStillRuns;
  double pause_left_s_, since_request_s_ = 0.0, drives_off_s_ = 0.0;
  bool in_command_ = false, echo_runs_ = false, stopping_ = false;
  std::uint32_t starts_ = 0, drops_ = 0;
};

}  // namespace voxtouch::lwr::fri
