#include "devices/fr3/fci_session.hpp"

#include <utility>

namespace voxtouch::fr3::fci {

std::string_view sentence_of(Diagnostic diagnostic) noexcept {
  switch (diagnostic) {
    case Diagnostic::kNone:
      return "no error";
    case Diagnostic::kStarting:
      return "no force: waiting for the robot's torque control";
    case Diagnostic::kRecovering:
      return "no force: the robot recovers from an error";
    case Diagnostic::kLostPackets:
      return "no force: the robot missed 20 consecutive commands. Use a separate network card and "
             "a real-time kernel. Retrying";
    case Diagnostic::kTorqueJump:
      return "no force: the robot detected a torque discontinuity (lost commands). Check the "
             "network. Retrying";
    case Diagnostic::kReflex:
      return "no force: a reflex stopped the arm. Guide it away from the obstacle, check the "
             "robot's web page and restart";
    case Diagnostic::kUserStop:
      return "no force: the user stop is pressed. Release it when the arm is free";
    case Diagnostic::kGuiding:
      return "no force: the guiding buttons are pressed. Release them";
    case Diagnostic::kNotReady:
      return "no force: the robot is not ready. Unlock its joints and activate FCI on its web "
             "page, and end other programs there";
    case Diagnostic::kRefused:
      return "no force: the robot refused torque control";
    case Diagnostic::kEnded:
      return "no force: the robot ended torque control (reason on its web page). Retrying";
    case Diagnostic::kTooOften:
      return "no force: torque control ended too often. Check the network and the robot's web "
             "page, then restart";
    case Diagnostic::kFast:
      return "no force: a joint exceeds its speed limit. Hold the arm";
  }
  return "unknown";
}

void FciSession::wait(Diagnostic diagnostic) noexcept {
  phase_ = Phase::kWaiting;
  diagnostic_ = diagnostic;
  waited_s_ = 0.0;
  due_.reset();
}

void FciSession::fail(Diagnostic diagnostic) noexcept {
  phase_ = Phase::kFailed;
  diagnostic_ = diagnostic;
  due_.reset();
}

void FciSession::ask(Request request, Phase phase, Diagnostic diagnostic) noexcept {
  due_ = request;
  phase_ = phase;
  diagnostic_ = diagnostic;
  waited_s_ = 0.0;
}

std::optional<Request> FciSession::due() noexcept { return std::exchange(due_, std::nullopt); }

void FciSession::end() noexcept {
  if (phase_ == Phase::kRunning || phase_ == Phase::kStarting)
    ask(Request::kStopMove, Phase::kEnding, Diagnostic::kEnded);
  else if (phase_ != Phase::kFailed)
    phase_ = Phase::kEnding;
}

void FciSession::answered(Request request, Outcome outcome) noexcept {
  if (phase_ == Phase::kFailed || phase_ == Phase::kEnding)
    return;
  if (outcome == Outcome::kSuccess && phase_ == Phase::kRecovering &&
      request == Request::kErrorRecovery)
    return wait(Diagnostic::kStarting);
  const bool fine = outcome == Outcome::kSuccess || outcome == Outcome::kStarted;
  if (fine)
    return;
  refusal_ = outcome;
  if (request == Request::kErrorRecovery)
    return fail(Diagnostic::kRefused);
  // The states also report the end of a running motion, with its reason.
  if (request == Request::kMove && phase_ == Phase::kStarting) {
    if (++restarts_ > rules_.most_restarts)
      return fail(Diagnostic::kRefused);
    wait(Diagnostic::kRefused);
  }
}

void FciSession::update_reflex(const State& state) noexcept {
  if (phase_ == Phase::kRecovering)
    return;
  const Errors all = state.errors | state.reflex;
  if (diagnostic_ != Diagnostic::kLostPackets && diagnostic_ != Diagnostic::kTorqueJump) {
    errors_ = all;
    if (all == 0 || (all & ~(kLostPacketsError | kTorqueJumpError)) != 0)
      return fail(Diagnostic::kReflex);
    if (++restarts_ > rules_.most_restarts)
      return fail(Diagnostic::kTooOften);
    return wait(all & kLostPacketsError ? Diagnostic::kLostPackets : Diagnostic::kTorqueJump);
  }
  if (waited_s_ >= rules_.pause_s)
    ask(Request::kErrorRecovery, Phase::kRecovering, diagnostic_);
}

void FciSession::update_idle() noexcept {
  switch (phase_) {
    case Phase::kWaiting:
      if (waited_s_ >= rules_.pause_s)
        ask(Request::kMove, Phase::kStarting,
            diagnostic_ == Diagnostic::kRefused ? diagnostic_ : Diagnostic::kStarting);
      return;
    case Phase::kRunning:
      if (++restarts_ > rules_.most_restarts)
        return fail(Diagnostic::kTooOften);
      return wait(Diagnostic::kEnded);
    case Phase::kStarting:
      if (waited_s_ < rules_.start_timeout_s)
        return;
      if (++restarts_ > rules_.most_restarts)
        return fail(Diagnostic::kTooOften);
      return wait(Diagnostic::kNotReady);
    case Phase::kRecovering:
    case Phase::kEnding:
    case Phase::kFailed:
      return;
  }
}

void FciSession::update(const State& state, double elapsed_s, bool fast) noexcept {
  waited_s_ += elapsed_s;
  stopped_s_ = state.mode == RobotMode::kUserStopped ? stopped_s_ + elapsed_s : 0.0;
  in_torque_control_ = state.mode == RobotMode::kMove &&
                       state.controller == ControllerMode::kExternal &&
                       state.generator_mode == dialect_->generator_mode;
  if (phase_ == Phase::kFailed || phase_ == Phase::kEnding)
    return;
  if (in_torque_control_) {
    if (phase_ == Phase::kStarting)
      phase_ = Phase::kRunning;
    if (phase_ != Phase::kRunning)
      return;  // of another program
    diagnostic_ = fast ? Diagnostic::kFast : Diagnostic::kNone;
    return;
  }
  switch (state.mode) {
    case RobotMode::kIdle:
      return update_idle();
    case RobotMode::kReflex:
      return update_reflex(state);
    case RobotMode::kUserStopped:
      wait(Diagnostic::kUserStop);
      if (stopped_s_ > rules_.user_stop_timeout_s)
        fail(Diagnostic::kUserStop);
      return;
    case RobotMode::kGuiding:
      return wait(Diagnostic::kGuiding);
    case RobotMode::kErrorRecovery:
      if (phase_ != Phase::kRecovering)
        wait(Diagnostic::kRecovering);
      return;
    case RobotMode::kMove:  // starting, or controlled by another program
      if (phase_ == Phase::kRunning)
        wait(Diagnostic::kEnded);
      return;
    case RobotMode::kOther:
      return wait(Diagnostic::kNotReady);
  }
}

}  // namespace voxtouch::fr3::fci
