#include "core/scene/design_ask.hpp"

namespace voxtouch {

std::string_view name_of(HandAsk hand) noexcept {
  switch (hand) {
    case HandAsk::kAsDeviceIsHeld: return "as the device is held";
    case HandAsk::kPen: return "pen";
    case HandAsk::kArm: return "arm";
    case HandAsk::kAnyPassive: return "any_passive";
    case HandAsk::kGiven: return "given by the scene";
  }
  return "unknown";
}

OperatorRange operator_range(const DesignAsk& ask, Grip grip) noexcept {
  if (ask.hand == HandAsk::kPen) grip = Grip::kPen;
  if (ask.hand == HandAsk::kArm) grip = Grip::kArm;
  OperatorRange out = hand_range(grip);
  if (ask.hand == HandAsk::kGiven) {
    out.translation = ask.given_translation;
    out.rotation = ask.given_rotation.value_or(out.rotation);
  }
  for (HandRange* axis : {&out.translation, &out.rotation}) {
    axis->any_passive = ask.hand == HandAsk::kAnyPassive;
    axis->may_release = ask.released;
  }
  return out;
}

}  // namespace voxtouch
