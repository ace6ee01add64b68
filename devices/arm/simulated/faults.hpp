#pragma once
/// What goes wrong at a simulated controller, and when: faults of the network, the arm and people
/// around it, on a schedule.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtouch::arm_sim {

/// Packets are the controller's measurements or states, answers the remote side's commands.
enum class FaultKind : std::uint8_t {
  kLoss,        ///< packets are lost; value: fraction, 1 by default
  kAnswerLoss,  ///< answers are lost; likewise
  kLate,        ///< packets leave late; value: seconds, 0.003 unless given
  kJitter,      ///< packets leave late by a random time; value: the most [s], 0.0005 unless given
  kReorder,    ///< a packet leaves after the one that follows; value: fraction, 1 (every other one)
               ///< by default
  kDuplicate,  ///< packets leave twice; value: fraction, 1 by default
  kNan,     ///< a measured angle is no number; value: joint 1..7, or 8 for the LWR's time stamp; 1
            ///< unless given
  kSilent,  ///< nothing is sent and nothing received, as with a pulled cable
  // LWR alone
  kDrivesOff,      ///< drives lose power, brakes close; value: bits of the drives, 127 unless given
  kDriveError,     ///< likewise, and the drives report an error
  kEmergencyStop,  ///< all drives off, brakes close
  kQuality,  ///< the quality is at most the value: 0 unacceptable, 1 bad, 2 OK; 1 unless given
  // FR3 alone
  kUserStop,  ///< the user stop is pressed, and released at the end
  kGuiding,   ///< the guiding buttons are pressed
  kReflex,    ///< a reflex at its begin; value: which error, 7 (cartesian reflex) unless given
  kNotReady,  ///< the joints are locked
  kClosed,    ///< the command channel is closed at its begin
};
inline constexpr std::size_t kFaultKinds = 17;

/// Acts from `start_s` on for `duration_s`, on the controller's clock.
struct Fault {
  FaultKind kind{};
  double start_s = 0.0;
  double duration_s = std::numeric_limits<double>::infinity();
  double value = 0.0;
};

/// What one controller knows of them.
struct ControllerFaults {
  std::string_view kinds;  ///< as they are typed, parted by single spaces
  double most_nan;         ///< largest value of kNan
};

/// KIND@START[:DURATION[:VALUE]] in seconds, DURATION "inf" for ever (as if left out):
/// "late@2.0:0.1", "loss@0:inf:0.02", "nan@1.5:0.001:3". Throws std::runtime_error that shows the
/// text and says what is wrong with it.
Fault parse_fault(std::string_view text, const ControllerFaults& known);

/// Real-time safe after construction.
class FaultSchedule {
 public:
  explicit FaultSchedule(std::vector<Fault> faults = {}) : faults_(std::move(faults)) {}
  /// The value of the first fault of this kind that acts at `time_s`.
  std::optional<double> active(FaultKind kind, double time_s) const noexcept {
    for (const Fault& f : faults_)
      if (f.kind == kind && time_s >= f.start_s - 1e-9 && time_s < f.start_s + f.duration_s - 1e-9)
        return f.value;
    return std::nullopt;
  }

 private:
  std::vector<Fault> faults_;
};

}  // namespace voxtouch::arm_sim
