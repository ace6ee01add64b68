#include "devices/lwr/simulated/krl_script.hpp"

namespace voxtouch::lwr_sim {

std::optional<lwr::fri::Control> control_of(std::int32_t strategy) noexcept {
  switch (static_cast<lwr::fri::Strategy>(strategy)) {
    case lwr::fri::Strategy::kPosition:
      return lwr::fri::Control::kPosition;
    case lwr::fri::Strategy::kCartesianImpedance:
      break;
    case lwr::fri::Strategy::kJointImpedance:
      return lwr::fri::Control::kJointImpedance;
  }
  return std::nullopt;
}

KrlScript::Request KrlScript::step(const Input& in, double elapsed_s) noexcept {
  waited_s_ += elapsed_s;
  if (waited_s_ + 1e-9 < pause_s_)
    return Request::kNone;
  waited_s_ = 0.0;
  if (in.run == lwr::fri::kHalt && echo_ == lwr::fri::kRun) {
    echo_ = lwr::fri::kHalt;
    return Request::kStop;
  }
  if (in.run == lwr::fri::kHalt && in.state == lwr::fri::State::kMon)
    return Request::kAcknowledge;
  if (in.run != lwr::fri::kRun || echo_ == lwr::fri::kRun || in.state != lwr::fri::State::kMon)
    return Request::kNone;
  const auto requested = control_of(in.strategy);
  const bool keeps = first_start_keeps_strategy_ && echo_ == lwr::fri::kKrlInitialised;
  if (requested && !keeps)
    control_ = *requested;
  return in.quality == lwr::fri::Quality::kPerfect && (requested || keeps) ? Request::kStart
                                                                           : Request::kNone;
}

}  // namespace voxtouch::lwr_sim
