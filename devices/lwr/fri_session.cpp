#include "devices/lwr/fri_session.hpp"

#include <algorithm>

namespace voxtouch::lwr::fri {
namespace {

/// kInvalid is below all others.
int rank(Quality quality) noexcept {
  return quality == Quality::kInvalid ? -1 : static_cast<int>(quality);
}

bool mode_fits(const MsrPacket& msr) noexcept {
  return msr.robot.control == Control::kJointImpedance;
}

}  // namespace

std::string_view sentence_of(Diagnostic diagnostic) noexcept {
  switch (diagnostic) {
    case Diagnostic::kNone:
      return "in command mode";
    case Diagnostic::kQualityTooLowToStart:
      return "the connection quality is too low to start. Reduce other load of machine and "
             "network, or use a longer period (friOpen)";
    case Diagnostic::kDrivesNotOn:
      return "the drives are off: switch them on and start the KRL program";
    case Diagnostic::kDrivesWentOff:
      return "the drives went off (emergency stop, enabling switch or controller stop): "
             "acknowledge on the panel, switch them on, restart";
    case Diagnostic::kDriveError:
      return "a drive reports an error: read and acknowledge it on the controller's panel";
    case Diagnostic::kProgramStillRuns:
      return "the KRL program has not followed the stop request ($FRI_FRM_INT[2] = 0). Check that "
             "it runs";
    case Diagnostic::kStarting:
      return "waiting for friStart of the KRL program";
    case Diagnostic::kStartTimedOut:
      return "the controller did not enter command mode in time. Check that the KRL program runs "
             "and calls friStart at $FRI_FRM_INT[2] = 1";
    case Diagnostic::kDroppedOut:
      return "the controller left command mode (late replies, or a limit; see its panel). Retrying "
             "after a pause";
    case Diagnostic::kTooManyDrops:
      return "the controller left command mode too often: see the messages on its panel, then "
             "restart";
    case Diagnostic::kQualityDropped:
      return "the connection quality dropped in command mode: force is off until it recovers";
    case Diagnostic::kWrongControlMode:
      return "the controller's control mode differs from $FRI_FRM_INT[1]: check that the KRL "
             "program sets $stiffness.strategy from it";
    case Diagnostic::kTooFast:
      return "a joint exceeds its speed limit: force is off until it is slower";
    case Diagnostic::kClosed:
      return "the controller closed the interface (friClose)";
    case Diagnostic::kStopping:
      return "stopping";
  }
  return "unknown";
}

devices::DeviceError error_of(Diagnostic diagnostic) noexcept {
  switch (diagnostic) {
    case Diagnostic::kDriveError:
    case Diagnostic::kTooManyDrops:
      return devices::DeviceError::kFault;
    case Diagnostic::kClosed:
      return devices::DeviceError::kDisconnected;
    default:
      return devices::DeviceError::kRecoverable;
  }
}

devices::DeviceError FriSession::error() const noexcept {
  const bool stay_off =
      diagnostic_ == Diagnostic::kDrivesWentOff && drives_off_s_ > rules_.drives_off_grace_s;
  return stay_off ? devices::DeviceError::kFault : error_of(diagnostic_);
}

void FriSession::request_stop() noexcept {
  stopping_ = true;
  halt(Diagnostic::kStopping, 0.0);
  diagnostic_ = Diagnostic::kStopping;
}

void FriSession::halt(Diagnostic why, double pause_s) noexcept {
  phase_ = Phase::kHalting;
  halted_by_ = why;
  pause_left_s_ = pause_s;
}

/// Classifies errors and drives: requires the operator, may recover, or has not been ready yet.
Diagnostic FriSession::drives(const MsrPacket& msr, double elapsed_s) noexcept {
  if (msr.robot.error != 0)
    return Diagnostic::kDriveError;
  const bool on = (msr.robot.power & kAllDrives) == kAllDrives;
  drives_off_s_ = on ? 0.0 : drives_off_s_ + elapsed_s;
  if (on)
    return Diagnostic::kNone;
  return starts_ ? Diagnostic::kDrivesWentOff : Diagnostic::kDrivesNotOn;
}

void FriSession::update(const MsrPacket& msr, double elapsed_s, Diagnostic arm) noexcept {
  const Diagnostic power = drives(msr, elapsed_s);
  const bool was_in_command = in_command_;
  const bool drives_on = (msr.robot.power & kAllDrives) == kAllDrives;
  in_command_ = msr.interface.state == State::kCmd && drives_on;
  echo_runs_ = msr.krl.integer[kToIntEcho] == kRun;
  pause_left_s_ = std::max(0.0, pause_left_s_ - elapsed_s);
  since_request_s_ += elapsed_s;
  if (stopping_) {
    diagnostic_ = Diagnostic::kStopping;
    return;
  }
  if (phase_ == Phase::kRunning && was_in_command && !in_command_) {
    ++drops_;
    halt(drops_ >= rules_.max_drops ? Diagnostic::kTooManyDrops : Diagnostic::kDroppedOut,
         rules_.pause_s);
  }
  const bool open = msr.interface.state == State::kMon || msr.interface.state == State::kCmd;
  if (!open || power != Diagnostic::kNone) {
    if (phase_ != Phase::kHalting)
      halt(open ? power : Diagnostic::kClosed, rules_.pause_s);
    diagnostic_ = open ? power : Diagnostic::kClosed;
    return;
  }
  advance(msr);
  diagnostic_ = judge(msr, arm);
}

void FriSession::advance(const MsrPacket& msr) noexcept {
  const bool mon = msr.interface.state == State::kMon;
  if (phase_ == Phase::kHalting && mon && !echo_runs_ && pause_left_s_ <= 0.0 &&
      halted_by_ != Diagnostic::kTooManyDrops)
    phase_ = Phase::kWaiting;
  if (phase_ == Phase::kWaiting && mon &&
      rank(msr.interface.quality) >= rank(rules_.start_quality)) {
    phase_ = Phase::kStarting;
    since_request_s_ = 0.0;
  }
  if ((phase_ == Phase::kWaiting || phase_ == Phase::kStarting) && in_command_) {
    if (mode_fits(msr)) {
      phase_ = Phase::kRunning;
      ++starts_;
    } else {
      halt(Diagnostic::kWrongControlMode, rules_.pause_s);
    }
  }
  if (phase_ == Phase::kStarting && since_request_s_ > rules_.start_timeout_s)
    halt(Diagnostic::kStartTimedOut, rules_.pause_s);
}

Diagnostic FriSession::judge(const MsrPacket& msr, Diagnostic arm) const noexcept {
  switch (phase_) {
    case Phase::kHalting:
      return halted_by_;
    case Phase::kWaiting:
      return Diagnostic::kQualityTooLowToStart;
    case Phase::kStarting:
      return Diagnostic::kStarting;
    case Phase::kRunning:
      break;
  }
  if (!mode_fits(msr))
    return Diagnostic::kWrongControlMode;
  if (rank(msr.interface.quality) < rank(rules_.keep_quality))
    return Diagnostic::kQualityDropped;
  return arm;
}

void FriSession::fill(Krl& krl) const noexcept {
  krl.integer[kFrmIntStrategy] = static_cast<std::int32_t>(Strategy::kJointImpedance);
  krl.integer[kFrmIntRun] = phase_ == Phase::kStarting || phase_ == Phase::kRunning ? kRun : kHalt;
}

}  // namespace voxtouch::lwr::fri
