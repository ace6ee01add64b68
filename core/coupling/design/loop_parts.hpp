#pragma once
/// The parts of the closed haptic loop as the designer sees them: device, operator, contact.
///
/// Translation and rotation are the same arithmetic in other units, so one struct serves both.
/// "Effort" is a force [N] or a torque [Nm]; inertia [kg] or [kg m^2]; damping [Ns/m] or [Nms/rad];
/// stiffness [N/m] or [Nm/rad]; resolution [m] or [rad]. Everything is at the hand, in the device's
/// units: scales of the scene are already in it.
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/device_description.hpp"

namespace voxtouch::coupling::design {

/// How a device moves along (or about) any of its axes.
struct AxisModel {
  double inertia_min = 0.0, inertia_max = 0.0;  ///< over the workspace, > 0
  double damping = 0.0;                         ///< viscous, the least over the workspace, >= 0
  double coulomb_friction = 0.0;                ///< dry friction, >= 0
  double resolution = 0.0;                      ///< step of the encoder, >= 0
  double max_effort = 0.0;                      ///< > 0
  double max_stiffness =
      std::numeric_limits<double>::infinity();  ///< what the device can show, > 0
  double effort_bandwidth_hz =
      std::numeric_limits<double>::infinity();  ///< first-order lag of the effort
};

/// When things happen in the loop.
struct LoopTiming {
  double period_s = 1e-3;  ///< T, nominal
  double delay_s = 0.0;    ///< from the sample to the effort, excluding the hold: network,
                           ///< computation and device together; >= 0
  double jitter = 0.2;     ///< the longest period is (1 + jitter) T; >= 0
  int lost_in_a_row = 1;   ///< samples that may be lost one after the other; their input is held
  double network_s = 0.0;  ///< the network's part of delay_s
};

/// How a device is usually held: between the fingers like a pen, or with hand and arm behind it.
enum class Grip : std::uint8_t { kPen, kArm };
/// "pen", "arm"; and back (false where the word is unknown, `grip` untouched).
std::string_view name_of(Grip grip) noexcept;
bool parse_grip(std::string_view word, Grip& grip) noexcept;

struct DeviceModel {
  std::string name;
  AxisModel translation, rotation;
  bool gives_torque = false;  ///< false: `rotation` is not used
  LoopTiming timing;
  Grip grip = Grip::kPen;
};

/// The device as the designer reads it. A real device's command leaves a period after its sample at
/// the latest; a simulated one applies it within the sample's own period.
DeviceModel model_of(const DeviceDescription& device);

/// What may hold the device. The ranges are used only where `any_passive` is false.
struct HandRange {
  bool any_passive = false;  ///< every hand that creates no energy, of whatever stiffness and mass
  bool may_release = true;   ///< the released device is one of the cases
  double mass_min = 0.0, mass_max = 0.0;
  double damping_min = 0.0, damping_max = 0.0;
  double stiffness_min = 0.0, stiffness_max = 0.0;
  bool operator==(const HandRange&) const = default;
};

struct OperatorRange {
  HandRange translation, rotation;
};

/// Least damping ratio that the slowest swing of the loop in contact is to have, with the device
/// released and with a hand. 0: none.
struct DampingFloors {
  double released = 0.1, held = 0.3;
};
/// Both by the one for a hand; released, it is a third of it.
constexpr DampingFloors floors_of(double held) noexcept { return {held / 3.0, held}; }

/// Stiffness that the scene can put before the coupling: of one point alone, and of all that may
/// push at once (the cap is already in it, where there is one).
struct ContactRange {
  double one_point = 0.0, all_points = 0.0;
  bool operator==(const ContactRange&) const = default;
};

/// Longest delay that can be designed for [periods]: the loop's matrix has a state for each.
inline constexpr double kMaxDelayPeriods = 200.0;

/// Masses, dampings, stiffnesses, periods, ... outside of these, zero aside where it has a meaning,
/// are numbers in a wrong unit or no device's at all; the searches of this folder would lose
/// themselves in rounding.
inline constexpr double kMinQuantity = 1e-12, kMaxQuantity = 1e12;

/// Everything that is wrong with the numbers, one sentence each that names field, value and rule;
/// empty: they can be designed for. `rotation` of a device without torque and the ranges of a hand
/// that may be any passive one are not looked at.
std::vector<std::string> check(const DeviceModel& device);
std::vector<std::string> check(const HandRange& hand);

}  // namespace voxtouch::coupling::design
