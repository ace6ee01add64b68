#pragma once
/// The coupling between contact and device at run time, one step per sample:
///
///   contact -> input policy -> scale -> clamp -> law -> + injected damping -> never_pull ->
///   limits -> fade_out -> command
///
/// If the force grows over three cycles without work of the operator (swing_watch.hpp), fade_out
/// reduces the command to zero over kFadeOutS and holds it there until `reset`.
#include <cstdint>
#include <optional>
#include <variant>

#include "core/coupling/direct.hpp"
#include "core/coupling/injected_damping.hpp"
#include "core/coupling/input_policy.hpp"
#include "core/coupling/passivity.hpp"
#include "core/coupling/shaping_filter.hpp"
#include "core/coupling/spring_damper.hpp"
#include "core/coupling/stiffness_scale.hpp"
#include "core/coupling/swing_watch.hpp"
#include "core/coupling/tool_motion.hpp"

namespace voxtouch::coupling {

/// Output of one sample, W axes. The bools are the command's status bits.
struct CouplingOutput {
  Wrench wrench;                ///< finite and within the limits for any input
  bool ramping = false;         ///< the input is being faded in
  bool repeated_input = false;  ///< the input was invalid; the last valid one was repeated
  bool clamped = false;         ///< input or command exceeded the device's range and was clamped
  bool capped = false;          ///< the contact was stiffer than the cap, so its wrench was scaled
  bool bounded = false;         ///< injected damping exceeded its bound and was limited
  /// Fraction of the contact's wrench that is within the caps; see StiffnessScale.
  double scale = 1.0;
  /// Net energy from the operator since this contact began, translation and rotation [J]; see
  /// passivity.hpp.
  double energy_j = 0.0;
  double energy_rotation_j = 0.0;
  /// Self-excited growth of the force: the command fades to zero and stays there.
  bool growing = false;
  double injected_n = 0.0;  ///< magnitude of the force of injected damping [N]
};

/// Counts since construction, for diagnostics.
struct CouplingCounters {
  std::uint64_t samples = 0;
  std::uint64_t faults = 0;    ///< invalid periods and inputs
  std::uint64_t repeated = 0;  ///< samples answered with a repeated input
  std::uint64_t clamped = 0, capped = 0;
  std::uint64_t bounded = 0;  ///< samples in which injected damping was limited
  std::uint64_t pose_jumps = 0;
  std::uint64_t not_finite = 0;  ///< non-finite commands; the law was restarted
  double lowest_energy_j = 0.0;  ///< of any single account of translation
  double lowest_energy_rotation_j = 0.0;
  Swing swing;           ///< the largest swing
  bool growing = false;  ///< the force grew by self-excitation and the command has faded to zero
  double most_force_n = 0.0, most_torque_nm = 0.0;          ///< largest of all commands
  double longest_path_m = 0.0, longest_rotation_rad = 0.0;  ///< of one period, under force
};

/// The coupling of one device, W axes. `step` and `reset` are real-time safe: no allocation, lock
/// or exception.
class RunningCoupling {
 public:
  /// `sample_time_s`: nominal period T [s]. `ramp_s`: duration of a fade-in [s]. `speeds`: largest
  /// plausible speeds of the tool [m/s, rad/s]; a faster displacement is a jump of the pose. Throws
  /// std::invalid_argument for the first error of `validate` and for an invalid ramp or speed
  /// limit.
  RunningCoupling(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                  double ramp_s = kDefaultRampS, const ToolSpeedLimits& speeds = {});

  /// Computes the command of one sample. `dt_s`: measured time since the last sample [s].
  /// Invalid periods and inputs and gaps: InputPolicy. Without contact no damping is added to the
  /// law's force; if the law's force is zero too, the command is zero.
  CouplingOutput step(const CouplingInput& input, double dt_s) noexcept;
  /// Restarts from rest at the force `start`, clamped to the limits, and fades from it to the
  /// contact, for a new session, a clutch or an intended jump of the pose. Clears velocity, energy
  /// and self-excited growth.
  void reset(const Wrench& start) noexcept;

  /// Changes the parameters at run time, also in contact, without a jump.
  /// Immediately: cut-off, damping ratio, velocity estimate. At kGainSlewPerS: the gain. Over
  /// kDefaultRampS: c and r of the spring-damper, and the caps. Over `ramp_behind_filter_s`:
  /// injected damping. Another kind starts at the present force. Returns false, unchanged, if
  /// `validate` refuses. Call it between two steps; it allocates only for the messages of validate.
  bool redesign(const CouplingSpec& spec);

  CouplingKind kind() const noexcept;
  double gain()
      const noexcept;  ///< present gain of the shaping filter during a ramp; 1 for the others
  const CouplingCounters& counters() const noexcept { return counters_; }
  const EnergyAccounts& energy() const noexcept { return passivity_.energy(); }
  /// Velocity estimate v^ of the tool, W axes.
  const Twist& velocity() const noexcept { return motion_.velocity(); }

 private:
  using Law = std::variant<DirectCoupling, ShapingFilter, SpringDamper>;  ///< index: CouplingKind
  static Law law_of(const CouplingSpec& spec, double sample_time_s) noexcept;
  void start_law_at(const Wrench& start) noexcept;
  double newly_supplied(const CouplingInput& input, double dt_s) noexcept;
  Wrench run_law(const CouplingInput& input, const PolicedSample& sample,
                 CouplingOutput& out) noexcept;
  void add_damping(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept;
  void limit_command(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept;
  void count_path() noexcept;
  void fade_out(double dt_s, Wrench& sum, CouplingOutput& out) noexcept;
  void count(const CouplingOutput& out) noexcept;

  CouplingLimits limits_;
  double nominal_s_;
  InputPolicy policy_;
  Law law_;
  StiffnessScale scale_;
  ToolMotion motion_;
  ToolStep step_;
  InjectedDamping injected_;
  Passivity passivity_;
  SwingWatch swing_;
  double fade_factor_ = 1.0;  ///< remaining fraction of the command after self-excited growth
  CouplingInput contact_;     ///< the last valid one, scaled
  Wrench law_output_;         ///< last output of the law
  bool in_contact_ = false;
  double displayed_ratio_ = 1.0;      ///< displayed fraction of a force in W, by scale and gain
  std::optional<double> supplied_j_;  ///< CouplingInput::supplied_energy_j of the last sample
  CouplingCounters counters_;

  static constexpr double kFadeOutS = 0.05;
};

}  // namespace voxtouch::coupling
