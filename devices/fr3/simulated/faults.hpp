#pragma once
/// What goes wrong at the simulated robot, and when: faults of the network, the arm, and people around it, on a schedule.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "devices/arm/simulated/faults.hpp"

namespace voxtouch::fr3_sim {

enum class FaultKind : std::uint8_t {
  kLoss,        ///< states are lost; value: share, 1 unless given
  kAnswerLoss,  ///< commands are lost; likewise
  kLate,        ///< states leave late; value: seconds, 0.003 unless given
  kJitter,      ///< states leave late by a random time; value: the most [s], 0.0005 unless given
  kReorder,     ///< a state leaves after the one that follows; value: share, 1 (every other one) unless given
  kDuplicate,   ///< states leave twice; value: share, 1 unless given
  kNan,         ///< a measured angle is no number; value: joint 1..7, 1 unless given
  kUserStop,    ///< somebody presses the user stop, and releases it at the end
  kGuiding,     ///< somebody presses the guiding buttons
  kReflex,      ///< a reflex at its begin; value: which error, 7 (cartesian reflex) unless given
  kNotReady,    ///< somebody locks the joints
  kSilent,      ///< nothing is sent and nothing heard on UDP, as with a pulled cable
  kClosed,      ///< the command channel is closed at its begin
};
inline constexpr std::size_t kFaultKinds = 13;

using Fault = arm_sim::Fault<FaultKind>;
using FaultSchedule = arm_sim::FaultSchedule<FaultKind>;

/// As arm_sim::parse_fault. Kinds: loss answer_loss late jitter reorder duplicate nan user_stop guiding reflex not_ready silent closed.
Fault parse_fault(std::string_view text);

}  // namespace voxtouch::fr3_sim
