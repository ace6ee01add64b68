#pragma once
/// Fault schedule of a simulated controller: faults of the network, of the arm and of its
/// operation.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace voxtouch::arm_sim {

/// Packets are measurements or states of the controller, replies the commands of the remote side.
enum class FaultKind : std::uint8_t {
  kLoss,        ///< packets are lost; value: fraction, 1 by default
  kAnswerLoss,  ///< replies are lost; value: fraction, 1 by default
  kLate,        ///< packets are sent late; value: seconds, 0.003 by default
  /// Packets are sent late by a random time; value: largest delay [s], 0.0005 by default.
  kJitter,
  /// A packet is sent after its successor; value: fraction, 1 (every other one) by default.
  kReorder,
  kDuplicate,  ///< packets are sent twice; value: fraction, 1 by default
  /// A measured angle is NaN; value: joint 1..7, or 8 for the LWR's time stamp; 1 by default.
  kNan,
  kSilent,  ///< nothing is sent or received, as with an unplugged cable
  // LWR only
  kDrivesOff,      ///< drives lose power, brakes close; value: bits of the drives, 127 by default
  kDriveError,     ///< drives lose power and report an error; value as above
  kEmergencyStop,  ///< all drives off, brakes close
  kQuality,        ///< the quality is at most the value: 0 unacceptable, 1 bad, 2 OK; 1 by default
  // FR3 only
  kUserStop,  ///< the user stop is pressed, and released at the end
  kGuiding,   ///< the guiding buttons are pressed
  kReflex,    ///< a reflex at the start; value: error number, 7 (cartesian reflex) by default
  kNotReady,  ///< the joints are locked
  kClosed,    ///< the command channel is closed at the start
};
inline constexpr std::size_t kFaultKinds = 17;

/// Active from `start_s` for `duration_s`, on the controller's clock.
struct Fault {
  FaultKind kind{};
  double start_s = 0.0;
  double duration_s = std::numeric_limits<double>::infinity();
  double value = 0.0;
};

/// The faults of one controller.
struct ControllerFaults {
  std::string_view kinds;  ///< names as typed, separated by single spaces
  double most_nan;         ///< largest value of kNan
};

/// Parses KIND@START[:DURATION[:VALUE]] in seconds, DURATION "inf" for permanent (the default):
/// "late@2.0:0.1", "loss@0:inf:0.02", "nan@1.5:0.001:3". Throws std::runtime_error with the text
/// and the fault in it.
Fault parse_fault(std::string_view text, const ControllerFaults& known);

/// Real-time safe after construction.
class FaultSchedule {
 public:
  explicit FaultSchedule(std::vector<Fault> faults = {}) : faults_(std::move(faults)) {}
  /// The value of the first fault of this kind that is active at `time_s`.
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
