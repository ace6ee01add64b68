#pragma once
/// The displayed force of a certified coupling on a device, computed before the start.
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/device_fit/fit_coupling.hpp"

namespace voxtouch::device_fit {

/// The limit of the stiffness at the hand.
enum class StiffnessLimit : std::uint8_t {
  kDevice,     ///< largest stable stiffness of the device
  kRequested,  ///< stiffness of contact and effects
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
  double gain_margin = 0.0;        ///< of the certificate
  double force_n = 0.0;            ///< at saturation: the largest of the device
  double depth_m = 0.0;            ///< depth of saturation; larger for a softer contact
  StiffnessLimit limit = StiffnessLimit::kLoop;
  bool returns_torque = true;        ///< false: rotation against a contact is latched
                                     ///< (core/rendering/latched_rotation.hpp)
  double rotation_nm_per_rad = 0.0;  ///< of the spring against rotation; 0: none
  double reach_m = 0.0;       ///< largest distance of a tool point from its origin; 0: unknown
  double grip_n_per_m = 0.0;  ///< requested grip of a body if it exceeds the certified one; else 0

  /// Displayed stiffness of a rigid contact at the tool's reach, pressed across the lever arm: the
  /// springs of translation and rotation act in series. Along the arm it is `stiffness_n_per_m`.
  ///
  ///     1 / k_across = 1 / k + reach^2 / k_rotation
  double across_n_per_m() const noexcept;
  bool operator==(const ForcePreview&) const = default;
};

/// Preview of `fitted`, which was fitted to `bounds`. `tool_reach_m`: at the hand; 0: unknown.
/// Empty if no force may be commanded or nothing is displayed. Not for the loop.
std::optional<ForcePreview> force_preview(const FittedCoupling& fitted, const scene::Scene& scene,
                                          const coupling::design::DeviceModel& device,
                                          const rendering::StiffnessBounds& bounds,
                                          double tool_reach_m = 0.0);

}  // namespace voxtouch::device_fit
