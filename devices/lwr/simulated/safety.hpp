#pragma once
/// Limits of the controller on commands and motion. Real-time safe.
#include <cstdint>
#include <numbers>
#include <string_view>

#include "devices/lwr/fri_packets.hpp"
#include "devices/lwr/simulated/lwr_plant.hpp"

namespace voxtouch::lwr_sim {

/// Why the controller left command mode or refused to enter it.
enum class Reason : std::uint8_t {
  kNone,
  kAsked,            ///< friStop
  kClosed,           ///< friClose
  kMisses,           ///< too many missing replies
  kNotFinite,        ///< a command contained NaN or Inf
  kFlagsChanged,     ///< cmdFlags changed in command mode
  kJump,             ///< the first command was not the mirrored position
  kCommandSpeed,     ///< a commanded position moved faster than the joint's limit
  kCommandPosition,  ///< a commanded position outside the joint's range
  kDeviation,        ///< a commanded position too far from the measured one
  kTorque,           ///< an overlaid torque over its limit
  kGains,            ///< stiffness or damping out of range
  kJointSpeed,       ///< a joint exceeded its speed limit
  kEmergencyStop,
  kDrivesOff,
  kQualityForced,  ///< by an injected fault
};
/// The reason as a sentence.
std::string_view sentence_of(Reason reason) noexcept;

/// A reason with the joints that it refers to, one bit each (0: none in particular).
struct Violation {
  Reason reason = Reason::kNone;
  std::uint16_t joints = 0;
  explicit operator bool() const noexcept { return reason != Reason::kNone; }
};

struct SafetyRules {
  lwr::LwrJoints max_speed_rad_s = lwr::lwr_limits().velocity_rad_s;  ///< measured and commanded
  lwr::LwrJoints max_position_rad = lwr::lwr_limits().position_rad;   ///< commanded, +-
  /// Overlaid ($stiffness.axismaxdeltatrq); assumed.
  lwr::LwrJoints max_torque_nm = lwr::lwr_limits().torque_nm;
  double max_deviation_rad =
      100.0 * std::numbers::pi / 180.0;      ///< $stiffness.axismaxdelta in published programs
  double max_stiffness_nm_per_rad = 2000.0;  ///< assumed
  double jump_rad = 0.01;                    ///< at the entry to command mode; assumed
};

/// Checks a reply against the previous one, `elapsed_s` earlier, and the present state of the arm.
Violation check_command(const SafetyRules& rules, const Setpoint& before, const Setpoint& now,
                        double elapsed_s, const lwr::LwrJoints& q) noexcept;
/// Checks the speed of the joints.
Violation check_motion(const SafetyRules& rules, const lwr::LwrJoints& rate) noexcept;
/// Whether command mode may begin. `mirrored`: the last commanded position. `expected`: that of the
/// controller.
Violation check_entry(const SafetyRules& rules, const lwr::LwrJoints& mirrored,
                      const lwr::LwrJoints& expected) noexcept;

}  // namespace voxtouch::lwr_sim
