#pragma once
/// One ring with one process killed or stopped during contact, and the result.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::attack {

struct RoundOptions {
  std::string victim = "rendering";  ///< device, rendering, coupling, logger, validator, up; or
                                     ///< none, to compare with
  int signal = 9;                    ///< SIGKILL or SIGSTOP
  std::uint32_t domain = 0;
  std::string rig = "haptic";
  std::vector<std::string> options = {};  ///< more of `up`
  int after_ms = 0;                       ///< of contact, before the signal
};

struct RoundResult {
  bool played = false;  ///< false: no contact was reached
  std::optional<double>
      zero_ms;  ///< from the signal to the first sample without force, by the device's samples
  std::optional<double>
      zero_wall_ms;         ///< the same by this machine's clock, until the device wrote it
  double machine_ms = 0.0;  ///< the longest time in this span that the machine kept a thread of the
                            ///< ring's priority waiting
  double gap_ms = 0.0;      ///< the longest time in this span without a sample of the device
  std::optional<double>
      bag_lost_s;  ///< of the device's samples that were seen, how much is missing at the bag's end
  int unforced = 0;  ///< samples without force while only a listener was stopped
  bool stalled =
      false;  ///< the machine delayed threads so long that force had to fade, or that zero was late
  int status = 0;                   ///< of `up`
  std::vector<std::string> faults;  ///< failed checks, a sentence each
};

/// Plays it; takes two to five seconds.
RoundResult play(const RoundOptions& ask);

/// The device must be at zero by then [ms of its samples]: three repeated periods, 20 ms of fade,
/// and the path of a command.
inline constexpr double kZeroWithinMs = 30.0;

}  // namespace voxtouch::attack
