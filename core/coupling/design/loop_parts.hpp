#pragma once
/// The parts of the closed haptic loop in the model of the designer: device, operator, contact.
///
/// Translation and rotation use the same arithmetic in different units, so one struct serves both.
/// "Effort" is a force [N] or a torque [Nm]; inertia [kg] or [kg m^2]; damping [Ns/m] or [Nms/rad];
/// stiffness [N/m] or [Nm/rad]; resolution [m] or [rad]. All values are at the hand, in the units
/// of the device, with the scales of the scene applied.
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/device_description.hpp"

namespace voxtouch::coupling::design {

/// Dynamics of a device along (or about) any of its axes.
struct AxisModel {
  double inertia_min = 0.0, inertia_max = 0.0;  ///< over the workspace, > 0
  double damping = 0.0;                         ///< viscous, the least over the workspace, >= 0
  double coulomb_friction = 0.0;                ///< dry friction, >= 0
  double resolution = 0.0;                      ///< encoder step, >= 0
  double max_effort = 0.0;                      ///< > 0
  /// Largest displayed stiffness of the device, > 0.
  double max_stiffness = std::numeric_limits<double>::infinity();
  /// First-order lag of the effort.
  double effort_bandwidth_hz = std::numeric_limits<double>::infinity();
};

/// Timing of the loop.
struct LoopTiming {
  double period_s = 1e-3;  ///< T, nominal
  /// Latency from sample to effort, excluding the zero-order hold: network, computation and device;
  /// >= 0.
  double delay_s = 0.0;
  double jitter = 0.2;         ///< the longest period is (1 + jitter) T; >= 0
  int consecutive_losses = 1;  ///< consecutive samples that may be lost; their input is held
  double network_s = 0.0;      ///< network's part of delay_s
};

/// Usual grip of a device: between the fingers like a pen, or with hand and arm.
enum class Grip : std::uint8_t { kPen, kArm };
/// "pen" or "arm". `parse_grip` leaves `grip` unchanged and returns false for another name.
std::string_view name_of(Grip grip) noexcept;
bool parse_grip(std::string_view word, Grip& grip) noexcept;

struct DeviceModel {
  std::string name;
  AxisModel translation, rotation;
  bool gives_torque = false;  ///< false: `rotation` is unused
  LoopTiming timing;
  Grip grip = Grip::kPen;
};

/// The device model of the designer. The command of a real device leaves at most one period after
/// its sample; a simulated device applies it within the sample's own period.
DeviceModel model_of(const DeviceDescription& device);

/// Range of hands on the device. The ranges are used only if `any_passive` is false.
struct HandRange {
  bool any_passive = false;  ///< every hand that creates no energy, of any stiffness and mass
  bool may_release = true;   ///< the released device is one of the cases
  double mass_min = 0.0, mass_max = 0.0;
  double damping_min = 0.0, damping_max = 0.0;
  double stiffness_min = 0.0, stiffness_max = 0.0;
  bool operator==(const HandRange&) const = default;
};

struct OperatorRange {
  HandRange translation, rotation;
};

/// Minimum damping ratio of the dominant mode in contact, with the device released and gripped. 0:
/// no minimum.
struct MinDampingRatios {
  double released = 0.1, gripped = 0.3;
};
/// Derives both from the ratio for a hand; the released ratio is a third of it.
constexpr MinDampingRatios min_damping_ratios_of(double gripped) noexcept {
  return {gripped / 3.0, gripped};
}

/// Contact stiffness of the scene ahead of the coupling: of a single point, and of all points that
/// may touch at once (with the cap applied, if any).
struct ContactRange {
  double one_point = 0.0, all_points = 0.0;
  bool operator==(const ContactRange&) const = default;
};

/// Longest delay of a design [periods]: the matrix of the loop has one state for each.
inline constexpr double kMaxDelayPeriods = 200.0;

/// Range of all quantities, apart from 0 where it is meaningful. A number outside is in a wrong
/// unit, and rounding would dominate the searches.
inline constexpr double kMinQuantity = 1e-12, kMaxQuantity = 1e12;

/// All errors in the numbers, one sentence each that names field, value and rule; empty if they are
/// valid. Ignores `rotation` of a device without torque and the ranges of a hand with
/// `any_passive`.
std::vector<std::string> check(const DeviceModel& device);
std::vector<std::string> check(const HandRange& hand);

}  // namespace voxtouch::coupling::design
