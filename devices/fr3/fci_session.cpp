#include "devices/fr3/fci_session.hpp"

#include <utility>

namespace voxtouch::fr3::fci {

std::string_view sentence_of(Trouble trouble) noexcept {
  switch (trouble) {
    case Trouble::kNone:
      return "nothing is wrong";
    case Trouble::kStarting:
      return "no force yet, waiting for the robot to begin torque control";
    case Trouble::kRecovering:
      return "no force, the robot recovers from an error";
    case Trouble::kLostPackets:
      return "no force, the robot missed 20 commands in a row: a network card of its own, a "
             "real-time kernel, no power saving; "
             "asked again by itself";
    case Trouble::kTorqueJump:
      return "no force, the robot saw torques jump, as lost commands make them: look at the "
             "network; asked again by itself";
    case Trouble::kReflex:
      return "no force, a reflex stopped the arm: lead it away from what it met, look at the "
             "robot's web page, and start anew";
    case Trouble::kUserStop:
      return "no force, the user stop is pressed: release it when the arm is free";
    case Trouble::kGuiding:
      return "no force, the arm is being guided by its buttons: let go of them";
    case Trouble::kNotReady:
      return "no force, the robot is not ready: unlock its joints and activate FCI on its web "
             "page, and end other programs there";
    case Trouble::kRefused:
      return "no force, the robot refused torque control";
    case Trouble::kEnded:
      return "no force, the robot ended torque control by itself: its web page says why; asked "
             "again by itself";
    case Trouble::kTooOften:
      return "no force, torque control ended too often: see to the network and to the robot's web "
             "page, and start anew";
    case Trouble::kFast:
      return "no force, a joint is too fast: hold the arm";
  }
  return "unknown";
}

void FciSession::wait(Trouble trouble) noexcept {
  phase_ = Phase::kWaiting;
  trouble_ = trouble;
  waited_s_ = 0.0;
  due_.reset();
}

void FciSession::fail(Trouble trouble) noexcept {
  phase_ = Phase::kFailed;
  trouble_ = trouble;
  due_.reset();
}

void FciSession::ask(Request request, Phase phase, Trouble trouble) noexcept {
  due_ = request;
  phase_ = phase;
  trouble_ = trouble;
  waited_s_ = 0.0;
}

std::optional<Request> FciSession::due() noexcept { return std::exchange(due_, std::nullopt); }

void FciSession::end() noexcept {
  if (phase_ == Phase::kRunning || phase_ == Phase::kStarting)
    ask(Request::kStopMove, Phase::kEnding, Trouble::kEnded);
  else if (phase_ != Phase::kFailed)
    phase_ = Phase::kEnding;
}

void FciSession::answered(Request request, Outcome outcome) noexcept {
  if (phase_ == Phase::kFailed || phase_ == Phase::kEnding)
    return;
  if (outcome == Outcome::kSuccess && phase_ == Phase::kRecovering &&
      request == Request::kErrorRecovery)
    return wait(Trouble::kStarting);
  const bool fine = outcome == Outcome::kSuccess || outcome == Outcome::kStarted;
  if (fine)
    return;
  refusal_ = outcome;
  if (request == Request::kErrorRecovery)
    return fail(Trouble::kRefused);
  // The end of a motion that ran is seen in the states as well, with its reason.
  if (request == Request::kMove && phase_ == Phase::kStarting) {
    if (++restarts_ > rules_.most_restarts)
      return fail(Trouble::kRefused);
    wait(Trouble::kRefused);
  }
}

void FciSession::see_reflex(const State& state) noexcept {
  if (phase_ == Phase::kRecovering)
    return;
  const Errors all = state.errors | state.reflex;
  if (trouble_ != Trouble::kLostPackets && trouble_ != Trouble::kTorqueJump) {
    errors_ = all;
    if (all == 0 || (all & ~(kLostPacketsError | kTorqueJumpError)) != 0)
      return fail(Trouble::kReflex);
    if (++restarts_ > rules_.most_restarts)
      return fail(Trouble::kTooOften);
    return wait(all & kLostPacketsError ? Trouble::kLostPackets : Trouble::kTorqueJump);
  }
  if (waited_s_ >= rules_.pause_s)
    ask(Request::kErrorRecovery, Phase::kRecovering, trouble_);
}

void FciSession::see_idle() noexcept {
  switch (phase_) {
    case Phase::kWaiting:
      if (waited_s_ >= rules_.pause_s)
        ask(Request::kMove, Phase::kStarting,
            trouble_ == Trouble::kRefused ? trouble_ : Trouble::kStarting);
      return;
    case Phase::kRunning:
      if (++restarts_ > rules_.most_restarts)
        return fail(Trouble::kTooOften);
      return wait(Trouble::kEnded);
    case Phase::kStarting:
      if (waited_s_ < rules_.start_timeout_s)
        return;
      if (++restarts_ > rules_.most_restarts)
        return fail(Trouble::kTooOften);
      return wait(Trouble::kNotReady);
    case Phase::kRecovering:
    case Phase::kEnding:
    case Phase::kFailed:
      return;
  }
}

void FciSession::see(const State& state, double elapsed_s, bool fast) noexcept {
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
      return;  // somebody else's
    trouble_ = fast ? Trouble::kFast : Trouble::kNone;
    return;
  }
  switch (state.mode) {
    case RobotMode::kIdle:
      return see_idle();
    case RobotMode::kReflex:
      return see_reflex(state);
    case RobotMode::kUserStopped:
      wait(Trouble::kUserStop);
      if (stopped_s_ > rules_.user_stop_timeout_s)
        fail(Trouble::kUserStop);
      return;
    case RobotMode::kGuiding:
      return wait(Trouble::kGuiding);
    case RobotMode::kErrorRecovery:
      if (phase_ != Phase::kRecovering)
        wait(Trouble::kRecovering);
      return;
    case RobotMode::kMove:  // on the way into it, or another controller's
      if (phase_ == Phase::kRunning)
        wait(Trouble::kEnded);
      return;
    case RobotMode::kOther:
      return wait(Trouble::kNotReady);
  }
}

}  // namespace voxtouch::fr3::fci
