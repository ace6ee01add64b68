#include "core/scene/design_options.hpp"

namespace voxtouch {

std::string_view name_of(HandOption hand) noexcept {
  switch (hand) {
    case HandOption::kAsDeviceIsHeld: return "as the device is held";
    case HandOption::kPen: return "pen";
    case HandOption::kArm: return "arm";
    case HandOption::kAnyPassive: return "any_passive";
    case HandOption::kGiven: return "given by the scene";
  }
  return "unknown";
}

OperatorRange operator_range(const DesignOptions& ask, Grip grip) noexcept {
  if (ask.hand == HandOption::kPen) grip = Grip::kPen;
  if (ask.hand == HandOption::kArm) grip = Grip::kArm;
  OperatorRange out = hand_range(grip);
  if (ask.hand == HandOption::kGiven) {
    out.translation = ask.given_translation;
    out.rotation = ask.given_rotation.value_or(out.rotation);
  }
  for (HandRange* axis : {&out.translation, &out.rotation}) {
    axis->any_passive = ask.hand == HandOption::kAnyPassive;
    axis->may_release = ask.released;
  }
  return out;
}

}  // namespace voxtouch
