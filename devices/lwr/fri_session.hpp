#pragma once
/// From the first packet to command mode and back: the handshake with the KRL program, and the
/// reason for zero force.
#include <cstdint>
#include <string>
#include <string_view>

#include "devices/driver.hpp"
#include "devices/lwr/fri_packets.hpp"

namespace voxtouch::lwr::fri {

/// Reason for zero force. Each has a sentence.
enum class Diagnostic : std::uint8_t {
  kNone,
  kQualityTooLowToStart,
  kDrivesNotOn,       ///< not yet on since the start of the program
  kDrivesWentOff,     ///< emergency stop, enabling switch, or a stop by the controller
  kDriveError,        ///< error bits
  kProgramStillRuns,  ///< the KRL program has not followed the request to stop
  kStarting,          ///< command mode was requested and has not begun
  kStartTimedOut,
  kDroppedOut,  ///< the controller left command mode by itself
  kTooManyDrops,
  kQualityDropped,    ///< in command mode
  kWrongControlMode,  ///< in command mode, but not with the requested strategy
  kTooFast,           ///< a joint exceeds its speed limit
  kClosed,            ///< friClose, or an invalid state
  kStopping,
};
/// Describes the diagnostic and the remedy in one sentence. Real-time safe.
std::string_view sentence_of(Diagnostic diagnostic) noexcept;
/// The corresponding device error; kRecoverable for kNone.
devices::DeviceError error_of(Diagnostic diagnostic) noexcept;

struct SessionRules {
  Quality start_quality = Quality::kPerfect;  ///< friStart is requested at this quality or better
  Quality keep_quality = Quality::kOk;        ///< in command mode force requires at least this
  double start_timeout_s = 5.0;               ///< from the request to command mode
  double pause_s = 0.5;  ///< after leaving command mode or a failed start, until the next request
  double drives_off_grace_s = 2.0;  ///< drives that stay off longer are a fault
  std::uint32_t max_drops = 10;     ///< after this many the operator must intervene
};

/// State machine of the handshake: measurements in, requests out. Real-time safe.
///
/// Each request is a value of the KRL variable $FRI_FRM_INT[2], which the program echoes in
/// $FRI_TO_INT[2]:
///   kHalting: 0 is requested. It ends in MON with drives on and an echo other than 1, after the
///   pause. A program still running from an earlier driver is thus stopped first.
///   kWaiting: still 0, until the quality is sufficient.
///   kStarting: 1 is requested: the program calls friStart.
///   kRunning: command mode; force is possible.
class FriSession {
 public:
  enum class Phase : std::uint8_t { kHalting, kWaiting, kStarting, kRunning };
  explicit FriSession(const SessionRules& rules) noexcept : rules_(rules), pause_left_s_(0.0) {}

  /// Processes one new measurement, `elapsed_s` after the previous one. `arm`: result of the arm's
  /// geometry for it (kNone, kTooFast).
  void update(const MsrPacket& msr, double elapsed_s, Diagnostic arm) noexcept;
  /// Permanently requests 0; no force.
  void request_stop() noexcept;
  /// Whether the stop is complete: the controller has left command mode, and the program has
  /// received the request.
  bool stopped() const noexcept { return stopping_ && !in_command_ && !echo_runs_; }

  /// Whether the controller executes the command (CMD, drives on). If so, this driver sets the
  /// position; otherwise it must mirror the controller's.
  bool in_command() const noexcept { return in_command_; }
  bool force_allowed() const noexcept { return diagnostic_ == Diagnostic::kNone; }
  Diagnostic diagnostic() const noexcept { return diagnostic_; }
  /// error_of the diagnostic; drives that stay off for longer than the grace time become a fault.
  devices::DeviceError error() const noexcept;
  Phase phase() const noexcept { return phase_; }
  /// Sets the program's variables: strategy and request.
  void fill(Krl& krl) const noexcept;

  std::uint32_t starts() const noexcept { return starts_; }  ///< times command mode was reached
  /// Times the controller left it by itself.
  std::uint32_t drops() const noexcept { return drops_; }

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
