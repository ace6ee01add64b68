#pragma once
/// Detects a self-excited oscillation: the tool moves to and fro without work of the operator.
#include <array>
#include <cstdint>

#include "core/coupling/tool_motion.hpp"
#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Device parameters that distinguish a swing from an ordinary motion, in W. 0: unknown or absent.
struct SwingDevice {
  double resolution_m = 0.0;
  double max_force_n = 0.0;
  double damping_ns_per_m = 0.0, coulomb_friction_n = 0.0;  ///< dissipated by the device
  /// From a command to its force; then a time constant.
  double delay_s = 0.0, force_lag_s = 0.0;
};

/// The largest swing since construction. A continued swing counts as one.
struct Swing {
  double frequency_hz = 0.0;
  double amplitude_m = 0.0;  ///< along the contact force, peak to peak
  double force_n = 0.0;      ///< of the command, peak to peak
  double duration_s = 0.0;   ///< of all swings together
  std::uint64_t swings = 0;  ///< number of swings begun
};

/// Detects swings from cycles between outermost points along the contact force, on one axis for two
/// opposite walls. Real-time safe.
///
/// Over a cycle the operator has put in the energy
///
///     E = b integral v^2 dt + F_c (path) - integral (f - f_mean) . v dt + (energy of effects)
///
/// with f the force at the device, after its delay and lag, and b and F_c the damping and friction
/// of the device. Without f_mean, a slow motion against a steady force would count as work. An
/// encoder step counts as a motion since the previous step, under the mean force of that time.
/// Injected damping is largest just after a step and decays until the next one. An operator who
/// moves the tool, on purpose or by tremor, puts in what coupling and device dissipate. In a
/// self-excited swing E is at most zero.
///
/// Threshold of E. Force and motion could exchange pi/4 of their peak-to-peak product. Less than
/// kHandWorks of that counts as zero, reduced by what an encoder step q hides: kHidden times q
/// times the force.
///
/// A swing is a sequence of cycles of similar period, without energy from the operator. It has at
/// least kCycles cycles, or at least three that last two seconds. It must not decay. It must exceed
/// three encoder steps (ten where a voluntary motion is possible) and 0.5 % of the device's force
/// (kLeastN if that is unknown). A cycle that ends further than kClosed of its amplitude from its
/// start does not count. When a tool slides over a texture, the energy of one wave is not
/// conclusive.
///
/// A growing swing has kGrowingCycles consecutive cycles of similar period. Each is larger in force
/// than the previous by kGrowth, and larger in motion.
class SwingWatch {
 public:
  static constexpr int kCycles = 8, kGrowingCycles = 3;
  static constexpr int kFastestSamples = 8;  ///< of a cycle; shorter ones are encoder noise
  static constexpr double kSlowestS = 1.0;   ///< [s]: longest cycle
  static constexpr double kSwingS = 2.0;     ///< [s]: shortest swing of fewer than kCycles cycles
  static constexpr double kLeastN = 0.05;    ///< [N]: least force of a swing, peak to peak
  static constexpr double kSteps = 3.5, kSlowSteps = 10.5;  ///< [encoder steps]: least amplitudes
  static constexpr double kHandWorks = 0.01;  ///< of the exchangeable energy: less counts as zero
  static constexpr double kHidden = 0.1;      ///< of an encoder step times the force: hidden work
  static constexpr double kAlike = 0.25;      ///< relative difference of similar periods
  static constexpr double kClosed = 1.0;      ///< of the amplitude: largest gap of a closed cycle
  static constexpr double kNoSmaller = 0.8;   ///< of the first amplitude: less is a decay
  static constexpr double kSmallerACycle = 0.03;  ///< decrease a cycle: more is a decay
  static constexpr double kGrowth = 1.15;         ///< force over that of the cycle before
  /// Voluntary motions have up to 4 Hz. In a slower cycle the operator must receive at least
  /// kReceivedRatio of the exchangeable energy, so that voluntary strokes do not count.
  static constexpr double kVoluntaryS = 0.25, kReceivedRatio = 0.1;
  /// Tremor has 7.5 to 13 Hz and less than kTremorM from peak to peak. A loop that amplifies it
  /// gives the hand a little energy. So such a cycle counts only if the hand receives kDampedRatio,
  /// as from a swing that it damps, or nothing, as if released.
  static constexpr double kTremorS = 1.0 / 7.5, kFastTremorS = 1.0 / 13.0, kTremorM = 2e-3,
                          kDampedRatio = 0.15;
  /// A growing swing with a smaller peak-to-peak force, as a fraction of the device's largest, is
  /// not ended.
  static constexpr double kGrowingForce = 0.02;

  explicit SwingWatch(const SwingDevice& device) noexcept : device_(device) {
    commands_.fill(Vec3::Zero());
  }

  /// Adds the step since the last sample, `dt_s` [s] ago, under `command`. `normal`: unit vector
  /// along the contact force, or zero. `supplied_j`: as for the passivity observer.
  void observe(const ToolStep& step, const Vec3& command, const Vec3& normal, double dt_s,
               double supplied_j) noexcept;
  /// Discards the current cycle, after a gap or for another session.
  void clear() noexcept;

  /// Resets everything except the largest swing.
  void restart() noexcept { grown_ = 0, clear(); }

  /// Whether the force grows by self-excitation; remains true.
  bool growing() const noexcept { return grown_ >= kGrowingCycles; }
  const Swing& largest() const noexcept { return largest_; }

 private:
  struct Cycle {
    int samples = 0;
    double period_s = 0.0, low_m = 0.0, high_m = 0.0, low_n = 0.0, high_n = 0.0;
    double taken_j = 0.0, worked_j = 0.0;  ///< by the device and from effects; by the force
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
  static bool tremor_like(const Cycle& cycle) noexcept;

  SwingDevice device_;
  Swing largest_;
  Cycle now_, last_;
  std::array<Vec3, 64> commands_;  ///< ring buffer, the newest at `newest_`
  std::size_t newest_ = 0;
  Vec3 lagged_ = Vec3::Zero(), axis_ = Vec3::Zero(), rested_sum_ = Vec3::Zero();
  int rested_ = 0;  ///< samples since the last encoder step; the sum of their forces is above
  double rested_s_ = 0.0;
  double position_m_ = 0.0,
         outermost_m_ = 0.0;  ///< along the axis; outermost since the last reversal
  bool outward_ = false;      ///< moving to larger positions
  bool swinging_ = false;
  int alike_ = 0, grown_ = 0;
  double alike_s_ = 0.0,
         first_m_ = 0.0;  ///< of similar cycles: their duration, the amplitude of the first
};

}  // namespace voxtouch::coupling
