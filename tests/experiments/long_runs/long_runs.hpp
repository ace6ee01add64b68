#pragma once
/// Runs long enough to show drift, leaks and slow-down. Each checks counts and drift; times are
/// only reported.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace voxtouch::long_runs {

using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// Results of every run.
struct Findings {
  std::vector<std::string> faults;  ///< failed checks, a sentence each; empty: passed
  std::vector<std::string> lines;   ///< figures, for people
  double slow_down = 1.0;           ///< CPU time of the last tenth over that of the first
  std::int64_t resident_growth = 0, heap_growth = 0;  ///< from the first tenth's end on [bytes]
};

/// The shaping filter: a constant contact at 5 Hz for `steps` samples; step responses at w0 T from
/// 1e-6 to beyond pi compared with their closed form; and periods that change at every sample with
/// a clock that stops, steps back and leaps. A tenth of `steps` each.
struct FilterRunOptions {
  std::uint64_t steps = 1'000'000'000, seed = 1;
};
Findings run_filter(const FilterRunOptions& ask, const Progress& progress = {});

/// A simulated Phantom moves over the cup, in contact most of the time, through the whole loop of
/// device, scene, coupling and guard. Afterwards a fixed motion must give results bit-identical to
/// those of a new loop.
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

/// Random contact through scene, contact (every model), effects, coupling and guard, with
/// floating-point traps for invalid, overflow and divide-by-zero. The first trap ends the process
/// by SIGFPE and prints its case and frame.
struct TrapRunOptions {
  std::filesystem::path scenes;  ///< the folder of the shipped scenes
  std::uint64_t frames = 1'000'000, seed = 1;
  std::optional<std::uint64_t> trip_at =
      {};  ///< divides by zero in this frame, to see that it is seen
};
Findings run_traps(const TrapRunOptions& ask, const Progress& progress = {});

/// Commands with random bits, stamps, sessions, sequence numbers and clocks, with gaps and device
/// errors, through gate and guard of every shipped device, and directly into the driver's check and
/// the common clamp. Checked independently of the guard: finite, within force, torque and slew
/// limits, ramped, and zero without valid commands.
struct CommandRunOptions {
  std::uint64_t commands = 100'000'000, seed = 1;
};
Findings run_commands(const CommandRunOptions& ask, const Progress& progress = {});

}  // namespace voxtouch::long_runs
