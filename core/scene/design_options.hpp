#pragma once
/// What a scene asks of a coupling that is to be designed, instead of setting its parameters.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/hand_ranges.hpp"

namespace voxtouch {

/// Whose hands the design has to be stable with.
enum class HandOption : std::uint8_t {
  kAsDeviceIsHeld,  ///< the range of the device's own grip
  kPen,
  kArm,
  kAnyPassive,  ///< every hand that creates no energy
  kGiven,       ///< the ranges that the scene gives
};
/// "as the device is held", "pen", "arm", "any_passive", "given by the scene": for people.
std::string_view name_of(HandOption hand) noexcept;

/// Values as in the scene file; what they mean for the designer is in design_problem.hpp.
struct DesignOptions {
  std::string kind = "auto";  ///< auto | shaping_filter | spring_damper | direct
  double cutoff_hz = 5.0;     ///< wish, w0 / (2 pi)
  double gain_margin = 2.0;   ///< >= 1
  /// Caps on the contact's stiffness in W that are wanted as they are; without both the designer is free to cap.
  std::optional<double> stiffness_cap_n_per_m, stiffness_cap_nm_per_rad;
  HandOption hand = HandOption::kAsDeviceIsHeld;
  HandRange given_translation;              ///< for kGiven
  std::optional<HandRange> given_rotation;  ///< for kGiven; none: the range of the device's grip
  bool released = true;                     ///< nobody holding the device is one of the cases
  bool inject_damping = true;               ///< damping while in contact is allowed
  bool run_infeasible = false;              ///< run what was found even where the design is called infeasible
};

/// The hands that `ask` means on a device that is held by `grip`.
OperatorRange operator_range(const DesignOptions& ask, Grip grip) noexcept;

}  // namespace voxtouch
