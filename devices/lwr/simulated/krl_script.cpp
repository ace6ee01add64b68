#include "devices/lwr/simulated/krl_script.hpp"

namespace voxtouch::lwr_sim {

std::optional<fri::Control> control_of(std::int32_t strategy) noexcept {
  switch (static_cast<fri::Strategy>(strategy)) {
    case fri::Strategy::kPosition: return fri::Control::kPosition;
    case fri::Strategy::kCartesianImpedance: break;
    case fri::Strategy::kJointImpedance: return fri::Control::kJointImpedance;
  }
  return std::nullopt;
}

KrlScript::Request KrlScript::step(const Input& in, double elapsed_s) noexcept {
  waited_s_ += elapsed_s;
  if (waited_s_ + 1e-9 < pause_s_) return Request::kNone;
  waited_s_ = 0.0;
  if (in.run == fri::kHalt && echo_ == fri::kRun) {
    echo_ = fri::kHalt;
    return Request::kStop;
  }
  if (in.run == fri::kHalt && in.state == fri::State::kMon) return Request::kAcknowledge;
  if (in.run != fri::kRun || echo_ == fri::kRun || in.state != fri::State::kMon) return Request::kNone;
  const auto wanted = control_of(in.strategy);
  const bool keeps = first_start_keeps_strategy_ && echo_ == fri::kKrlInitialised;
  if (wanted && !keeps) control_ = *wanted;
  return in.quality == fri::Quality::kPerfect && (wanted || keeps) ? Request::kStart : Request::kNone;
}

}  // namespace voxtouch::lwr_sim
