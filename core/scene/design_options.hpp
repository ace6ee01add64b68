#pragma once
/// Requests of a scene to the designer of the coupling, and ranges of hands.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/coupling/coupling_spec.hpp"
#include "core/coupling/design/loop_parts.hpp"

namespace voxtouch::scene {

/// Hands for which the design must be stable.
enum class HandOption : std::uint8_t {
  kAsDeviceIsHeld,  ///< the range of the device's grip
  kPen,
  kArm,
  kAnyPassive,  ///< every hand that creates no energy
  kGiven,       ///< the ranges that the scene gives
};
/// "default of the device", "pen", "arm", "any_passive", "given by the scene", for messages.
std::string_view name_of(HandOption hand) noexcept;

/// Values of the scene file; design_problem.hpp converts them for the designer.
struct DesignOptions {
  std::string kind = "auto";  ///< auto | shaping_filter | spring_damper | direct
  double cutoff_hz = 5.0;     ///< goal, w0 / (2 pi)
  double gain_margin = 2.0;   ///< >= 1
  double min_damping_ratio =
      0.3;  ///< minimum of translation when gripped, a third of it released; 0: none
  double rotation_min_damping_ratio = 0.0;  ///< the same of rotation
  std::optional<double>
      damping_force_ratio;  ///< as in CouplingSpec; unset: the designer chooses one
  /// Requested caps on the contact's stiffness in W; without both the designer chooses caps.
  std::optional<double> stiffness_cap_n_per_m, stiffness_cap_nm_per_rad;
  HandOption hand = HandOption::kAsDeviceIsHeld;
  coupling::design::HandRange given_translation;  ///< for kGiven
  std::optional<coupling::design::HandRange>
      given_rotation;            ///< for kGiven; unset: the range of the device's grip
  bool released = true;          ///< the released device is one of the cases
  bool inject_damping = true;    ///< damping while in contact is allowed
  bool velocity_windows = true;  ///< also on the velocity of a window
  bool run_infeasible = false;   ///< run the design even if it is infeasible
  bool operator==(const DesignOptions&) const = default;
};

/// The range of hands for a grip, including the released device. Apparent at the device: mass,
/// damping and stiffness add to those of the device.
///
/// Translation: engineering ranges. Arm: around published fits of its end point (0.55 kg, 6.5 Ns/m,
/// 135 N/m; 1.3 kg). Pen: no published coefficients could be confirmed. Both are extended towards
/// the light and soft end, which is the hard one.
///
/// Rotation: ASSUMPTIONS; no published ranges were found. Each is the translational one times the
/// square of the lever of the grip. Pen: the fingers' mass is 3 cm from the tool's origin (2e-5 to
/// 2e-4 kg m^2). They hold it at two places, the tip and the fold of the thumb, 5 to 7 cm apart
/// (0.1 to 2 Nm/rad, 2e-3 to 0.03 Nms/rad). Arm: fist and forearm at 8 to 10 cm (2e-3 to 2e-2 kg
/// m^2), held by wrist and elbow with levers of 13 to 16 cm (1 to 15 Nm/rad, 0.05 to 0.6 Nms/rad).
coupling::design::OperatorRange hand_range(coupling::design::Grip grip) noexcept;

/// The hands of `options` for a device with this grip.
coupling::design::OperatorRange operator_range(const DesignOptions& options,
                                               coupling::design::Grip grip) noexcept;

}  // namespace voxtouch::scene
