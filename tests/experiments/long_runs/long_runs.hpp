#pragma once
/// Runs that are long enough for drift, leaks and slow-down to show. Each gates on counts and
/// drift; times are reported, not judged.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::long_runs {

using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// What every run reports.
struct Findings {
  std::vector<std::string> faults;  ///< what did not hold, a sentence each; empty: all is well
  std::vector<std::string> lines;   ///< figures, for people
  double slow_down = 1.0;           ///< CPU time of the last tenth over that of the first
  std::int64_t resident_growth = 0, heap_growth = 0;  ///< from the first tenth's end on [bytes]
};

/// The shaping filter: a contact held at 5 Hz for `steps` samples; step responses at w0 T from 1e-6
/// to beyond pi against their closed form, and periods that change at every sample with a clock
/// that stops, steps back and leaps, a tenth of `steps` each.
struct FilterRunOptions {
  std::uint64_t steps = 1'000'000'000, seed = 1;
};
Findings run_filter(const FilterRunOptions& ask, const Progress& progress = {});

/// A simulated Phantom wanders over the cup, in contact most of the time, round the whole loop of
/// device, scene, coupling and guard. Afterwards what has run answers a fixed motion with
/// bit-identical results as what is new.
struct ContactRunOptions {
  std::filesystem::path scene;
  std::string model;  ///< empty: the scene's
  std::uint64_t frames = 10'000'000, seed = 1;
};
Findings run_contact(const ContactRunOptions& ask, const Progress& progress = {});

/// A rigid body that tumbles under changing torques: whether its orientation stays a rotation, to
/// the last bits.
struct TumbleRunOptions {
  std::uint64_t steps = 1'000'000'000;
};
Findings run_tumble(const TumbleRunOptions& ask, const Progress& progress = {});

/// Random contact through scene, contact (every model), effects, coupling and guard with the
/// floating-point traps invalid, overflow and divide-by-zero on. The first trap ends the process by
/// SIGFPE, and says in which frame of which case it was.
struct TrapRunOptions {
  std::filesystem::path scenes;  ///< the folder of the shipped scenes
  std::uint64_t frames = 1'000'000, seed = 1;
  std::optional<std::uint64_t> trip_at =
      {};  ///< divides by zero in this frame, to see that it is seen
};
Findings run_traps(const TrapRunOptions& ask, const Progress& progress = {});

/// Commands of any bits, with any stamps, sessions, sequence numbers and clocks, with gaps and
/// device errors, through gate and guard of every shipped device; and straight at the driver's own
/// check, and at what all of them cut with. Judged apart from the guard: finite, within force,
/// torque and slew limits, ramped, and zero once none good speaks.
struct CommandRunOptions {
  std::uint64_t commands = 100'000'000, seed = 1;
};
Findings run_commands(const CommandRunOptions& ask, const Progress& progress = {});

}  // namespace voxtouch::long_runs
