#pragma once
/// What goes wrong, and when: faults of the network, the robot and the controller, on a schedule.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "devices/arm/simulated/faults.hpp"

namespace voxtouch::lwr_sim {

enum class FaultKind : std::uint8_t {
  kLoss,        ///< measurements are lost; value: share, 1 unless given
  kAnswerLoss,  ///< answers are lost; likewise
  kLate,        ///< measurements leave late; value: seconds, 0.003 unless given
  kJitter,      ///< measurements leave late by a random time; value: the most [s], 0.0005 unless given
  kReorder,     ///< a measurement leaves after the one that follows; value: share, 1 (every other one) unless given
  kDuplicate,   ///< measurements leave twice; value: share, 1 unless given
  kNan,         ///< a measured joint position is no number; value: joint 1..7, or 8 for the time stamp; 1 unless given
  kDrivesOff,   ///< drives lose power, brakes close; value: bits of the drives, 127 unless given
  kDriveError,  ///< likewise, and the drives report an error
  kEmergencyStop,  ///< all drives off, brakes close
  kQuality,        ///< the quality is at most the value: 0 unacceptable, 1 bad, 2 OK; 1 unless given
  kSilent,         ///< nothing is sent and nothing heard, as with a pulled cable
};
inline constexpr std::size_t kFaultKinds = 12;

using Fault = arm_sim::Fault<FaultKind>;
using FaultSchedule = arm_sim::FaultSchedule<FaultKind>;

/// As arm_sim::parse_fault. Kinds: loss answer_loss late jitter reorder duplicate nan drives_off drive_error estop quality silent.
Fault parse_fault(std::string_view text);

}  // namespace voxtouch::lwr_sim
