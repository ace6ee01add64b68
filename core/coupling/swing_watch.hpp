#pragma once
/// Finds a loop that swings: the tool goes to and fro, and it is not the hand that keeps it going.
#include <array>
#include <cstdint>

#include "core/coupling/tool_motion.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// What of the device decides whether a movement to and fro is a swing, in W. 0: unknown, or none.
struct SwingDevice {
  double resolution_m = 0.0;
  double max_force_n = 0.0;
  double damping_ns_per_m = 0.0, coulomb_friction_n = 0.0;  ///< what the device takes by itself
  double delay_s = 0.0,
         force_lag_s = 0.0;  ///< from a command to its force; time constant behind that
};

/// The largest swing since construction. A swing that goes on is one.
struct Swing {
  double frequency_hz = 0.0;
  double amplitude_m = 0.0;  ///< along the contact's force, from peak to peak
  double force_n = 0.0;      ///< likewise, of the command
  double duration_s = 0.0;   ///< of all swings together
  std::uint64_t swings = 0;  ///< that have begun
};

/// Cycles from one outermost point to the next, along the contact's force; of two walls that is one
/// axis. Over a cycle the hand has put in
///
///     E = b integral v^2 dt + F_c (path) - integral (f - f_mean) . v dt + (what effects were free
///     to give),
///
/// f the force at the device: the command behind its delay and lag; b and F_c the device's. Without
/// f_mean a slow motion against a steady force counts as work. A step of the encoder is a motion
/// since the step before, under the mean force of that time: injected damping is largest behind a
/// step and least before one. A hand that moves the tool to and fro, on purpose or by tremor, puts
/// in what coupling and device take; in a loop that swings by itself E is at most nothing. Of what
/// force and motion could exchange, pi/4 of force times motion from peak to peak, less than
/// kHandWorks counts as nothing, less what an encoder's step q hides: kHidden times q times the
/// force.
///
/// A swing: cycles in a row that are alike in period, at least kCycles or two seconds, three at
/// least; no smaller at the end, larger than three steps of the encoder (ten where a hand may move
/// on purpose) and than 0.5 % of the device's force (kLeastN where that is unknown), in which the
/// hand puts in nothing. A cycle that ends further than kClosed of its amplitude from its begin is
/// none: of a tool that slides on over a texture the energy of a wave says nothing. Growing:
/// kGrowingCycles in a row, alike in period, each by kGrowth larger in force than the one before
/// and larger in motion, likewise. Real-time safe.
class SwingWatch {
 public:
  static constexpr int kCycles = 8, kGrowingCycles = 3;
  static constexpr int kFastestSamples = 8;  ///< of a cycle; what is shorter is the encoder's
  static constexpr double kHandWorks = 0.01, kGrowth = 1.15, kAlike = 0.25, kNoSmaller = 0.8,
                          kLeastN = 0.05, kSlowestS = 1.0;
  static constexpr double kHidden = 0.1, kClosed = 2.0, kSteps = 3.5, kSlowSteps = 10.5;
  static constexpr double kSmallerACycle = 0.03, kSwingS = 2.0;
  /// A hand moves on purpose at up to 4 Hz: slower than that it has to take this much, so that its
  /// own strokes are none.
  static constexpr double kVoluntaryS = 0.25, kHandTakes = 0.1;
  /// Force from peak to peak below which a growing swing is none that is to be ended, as part of
  /// the device's largest.
  static constexpr double kGrowingForce = 0.02;

  explicit SwingWatch(const SwingDevice& device) noexcept : device_(device) {
    commands_.fill(Vec3::Zero());
  }

  /// The step since the last sample, `dt_s` ago, under `command`; `normal` of length one along the
  /// contact's force, or zero; `supplied_j` as for the passivity observer.
  void see(const ToolStep& step, const Vec3& command, const Vec3& normal, double dt_s,
           double supplied_j) noexcept;
  /// What was seen so far is no part of what comes: a gap, another session.
  void forget() noexcept;

  /// As new, but for the largest swing.
  void restart() noexcept { grown_ = 0, forget(); }

  bool swinging() const noexcept { return swinging_; }
  /// Force grows by itself; stays so.
  bool growing() const noexcept { return grown_ >= kGrowingCycles; }
  const Swing& largest() const noexcept { return largest_; }

 private:
  struct Cycle {
    int samples = 0;
    double period_s = 0.0, low_m = 0.0, high_m = 0.0, low_n = 0.0, high_n = 0.0;
    double taken_j = 0.0, worked_j = 0.0;  ///< by the device and what effects gave; by the force
    Vec3 force_sum = Vec3::Zero(), shift = Vec3::Zero();
    double amplitude_m() const noexcept { return high_m - low_m; }
    double force_n() const noexcept { return high_n - low_n; }
    double hand_j() const noexcept { return taken_j - worked_j + force_sum.dot(shift) / samples; }
  };
  Vec3 force_at_device(const Vec3& command, double dt_s) noexcept;
  void begin_cycle(double force_n) noexcept;
  void end_cycle() noexcept;
  void watch_growth(bool by_itself, bool like) noexcept;
  bool large_enough(const Cycle& cycle) const noexcept;
  bool without_hand(const Cycle& cycle) const noexcept;

  SwingDevice device_;
  Swing largest_;
  Cycle now_, last_;
  std::array<Vec3, 64> commands_;  ///< a ring, the newest at `newest_`
  std::size_t newest_ = 0;
  Vec3 lagged_ = Vec3::Zero(), axis_ = Vec3::Zero(), rested_sum_ = Vec3::Zero();
  int rested_ = 0;  ///< samples since the encoder's last step, and above the sum of their forces
  double rested_s_ = 0.0;
  double position_m_ = 0.0, turn_m_ = 0.0;  ///< along the axis; outermost since the last turn
  bool outward_ = false;                    ///< on the way to larger positions
  bool swinging_ = false;
  int alike_ = 0, grown_ = 0;
  double alike_s_ = 0.0,
         first_m_ = 0.0;  ///< of those that are alike: their time, the amplitude of the first
};

}  // namespace voxtouch::coupling
