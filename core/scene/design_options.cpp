#include "core/scene/design_options.hpp"

namespace voxtouch::scene {
namespace {

coupling::design::HandRange range(double mass_min, double mass_max, double damping_min,
                                  double damping_max, double stiffness_min,
                                  double stiffness_max) noexcept {
  coupling::design::HandRange out;
  out.mass_min = mass_min, out.mass_max = mass_max;
  out.damping_min = damping_min, out.damping_max = damping_max;
  out.stiffness_min = stiffness_min, out.stiffness_max = stiffness_max;
  return out;
}

}  // namespace

coupling::design::OperatorRange hand_range(coupling::design::Grip grip) noexcept {
  if (grip == coupling::design::Grip::kPen)
    return {range(0.02, 0.2, 0.5, 8.0, 20.0, 800.0), range(2e-5, 2e-4, 2e-3, 0.03, 0.1, 2.0)};
  return {range(0.3, 2.0, 3.0, 30.0, 50.0, 600.0), range(2e-3, 2e-2, 0.05, 0.6, 1.0, 15.0)};
}

std::string_view name_of(HandOption hand) noexcept {
  switch (hand) {
    case HandOption::kAsDeviceIsHeld:
      return "default of the device";
    case HandOption::kPen:
      return "pen";
    case HandOption::kArm:
      return "arm";
    case HandOption::kAnyPassive:
      return "any_passive";
    case HandOption::kGiven:
      return "from the scene";
  }
  return "unknown";
}

coupling::design::OperatorRange operator_range(const DesignOptions& options,
                                               coupling::design::Grip grip) noexcept {
  if (options.hand == HandOption::kPen)
    grip = coupling::design::Grip::kPen;
  if (options.hand == HandOption::kArm)
    grip = coupling::design::Grip::kArm;
  coupling::design::OperatorRange out = hand_range(grip);
  if (options.hand == HandOption::kGiven) {
    out.translation = options.given_translation;
    out.rotation = options.given_rotation.value_or(out.rotation);
  }
  for (coupling::design::HandRange* axis : {&out.translation, &out.rotation}) {
    axis->any_passive = options.hand == HandOption::kAnyPassive;
    axis->may_release = options.released;
  }
  return out;
}

}  // namespace voxtouch::scene
