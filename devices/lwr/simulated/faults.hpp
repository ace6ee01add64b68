#pragma once
/// What goes wrong, and when: faults of the network, the robot and the controller, on a schedule.
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Acts from `start_s` on for `duration_s`, on the controller's clock.
struct Fault {
  FaultKind kind = FaultKind::kLoss;
  double start_s = 0.0;
  double duration_s = std::numeric_limits<double>::infinity();
  double value = 0.0;
};

/// KIND@START[:DURATION[:VALUE]] in seconds, DURATION "inf" for ever (as if left out): "late@2.0:0.1", "loss@0:inf:0.02",
/// "nan@1.5:0.001:3". Kinds: loss answer_loss late jitter reorder duplicate nan drives_off drive_error estop quality silent.
/// Throws std::runtime_error that shows the text and says what is wrong with it.
Fault parse_fault(std::string_view text);

/// Real-time safe after construction.
class FaultSchedule {
 public:
  explicit FaultSchedule(std::vector<Fault> faults = {}) : faults_(std::move(faults)) {}
  /// The value of the first fault of this kind that acts at `time_s`.
  std::optional<double> active(FaultKind kind, double time_s) const noexcept;

 private:
  std::vector<Fault> faults_;
};

}  // namespace voxtouch::lwr_sim
