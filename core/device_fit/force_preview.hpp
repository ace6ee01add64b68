#pragma once
/// What a hand gets of a certified coupling on a device, known before anything runs.
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/device_fit/fit_coupling.hpp"

namespace voxtouch::device_fit {

/// What keeps the stiffness at the hand from being higher.
enum class StiffnessLimit : std::uint8_t {
  kDevice,     ///< the device displays no more stably
  kRequested,  ///< contact and effects of the scene have no more
  kLever,      ///< a virtual tool resists rotation with the same spring times its lever squared
  kLoop,       ///< the certificate of the designed coupling
  kSetByHand,  ///< the coupling that the scene sets by hand
};
/// "device", "requested", "lever", "loop", "set_by_hand".
std::string_view name_of(StiffnessLimit limit) noexcept;
std::optional<StiffnessLimit> stiffness_limit_of(std::string_view name) noexcept;

/// All at the hand.
struct ForcePreview {
  double stiffness_n_per_m = 0.0;  ///< certified
  double gain_margin = 0.0;        ///< that it is certified with
  double force_n = 0.0;            ///< at saturation: the largest of the device
  double depth_m = 0.0;  ///< where that stiffness reaches it; a softer contact does so deeper
  StiffnessLimit limit = StiffnessLimit::kLoop;
  bool returns_torque = true;  ///< false: a turn of the tool against a contact is held
                               ///< (core/rendering/latched_rotation.hpp)
  double rotation_nm_per_rad =
      0.0;               ///< of the spring against rotation; 0: the tool rotates with the hand only
  double reach_m = 0.0;  ///< farthest point of the tool from its origin; 0: not known
  double grip_n_per_m =
      0.0;  ///< of a body, where the scene asks for more than is certified; 0: it does not

  /// Displayed by a rigid contact at the tool's reach, pressed across the arm to it: the tool
  /// rotates under the contact's lever, and the springs along and about act in a row. Along the arm
  /// it is `stiffness_n_per_m`.
  ///
  ///     1 / k_across = 1 / k + reach^2 / k_rotation
  double across_n_per_m() const noexcept;
  bool operator==(const ForcePreview&) const = default;
};

/// Of `fitted`, which was fitted to `bounds`; `tool_reach_m` at the hand, 0 where it is not known.
/// None where no force may be commanded or nothing is displayed. Not for the loop.
std::optional<ForcePreview> force_preview(const FittedCoupling& fitted, const scene::Scene& scene,
                                          const coupling::design::DeviceModel& device,
                                          const rendering::StiffnessBounds& bounds,
                                          double tool_reach_m = 0.0);

}  // namespace voxtouch::device_fit
