#pragma once
/// One ring whose rendering and coupling have a standby, one of the two lost while the hand feels a
/// contact, and what the device saw of it.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::attack {

struct FailoverOptions {
  std::string victim = "rendering";  ///< or coupling
  int signal = 9;                    ///< SIGKILL; or SIGSTOP, with SIGCONT after 0.7 s
  std::uint32_t domain = 0;
  std::string scene = "press_virtual_tool",
              motion = "press";           ///< forces of newtons, that change slowly
  std::vector<std::string> options = {};  ///< more of `up`
  std::filesystem::path keys = {};        ///< folder of --security; empty: plain
  int after_ms = 0;                       ///< of contact, before the signal
  bool up_waits = false;  ///< `up` is stopped meanwhile, and looks only when it is asked to end
};

struct FailoverResult {
  bool played = false;  ///< false: the ring did not come into contact with both pairs known
  double takeover_periods =
      0.0;           ///< between the last sample that was answered before and the next one that was
  int unforced = 0;  ///< samples of the device without force, from the signal on to the end
  int answered_twice = 0;  ///< samples whose command the device took twice
  int sent_late = 0;    ///< commands that came behind one to the same or a later sample: the device
                        ///< takes none of them
  double step_n = 0.0;  ///< of the commanded force over the takeover ...
  double usual_step_n = 0.0;    ///< ... the largest between two samples in the second before, ...
  double ramp_step_n = 0.0;     ///< ... and what the force guard's ramp allows in as many periods
  std::uint64_t takeovers = 0;  ///< of all, in the whole run
  std::string who;              ///< likewise, by name, as JSON
  double machine_ms =
      0.0;  ///< how long the machine kept a thread of the ring's priority waiting meanwhile
  bool stalled = false;             ///< so long that a takeover may be late or needless by it
  int status = 0;                   ///< of `up`
  std::vector<std::string> faults;  ///< what did not hold, a sentence each
};

/// Plays it; takes about five seconds.
FailoverResult play(const FailoverOptions& ask);

}  // namespace voxtouch::attack
