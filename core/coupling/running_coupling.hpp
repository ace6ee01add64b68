#pragma once
/// All that stands between contact and device at run time, in one step a sample.
///
///   contact -> input policy -> scale -> clamp -> law -> + injected damping -> never pulling ->
///   limits -> command
///
/// Where force grows over three periods without the hand's work (swing_watch.hpp) the command goes
/// to zero over kGiveUpS and stays there until `reset`.
///
/// The law is one of the three couplings. The passivity observer looks on.
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

/// One sample's answer, W axes. The bools are the command's status bits.
struct CouplingOutput {
  Wrench wrench;                ///< finite and within the limits, whatever came in
  bool ramping = false;         ///< the input is still being faded in
  bool repeated_input = false;  ///< the input was not usable; the last good one was used again
  bool clamped = false;         ///< input or command was over the device's range and was cut
  bool capped = false;          ///< the contact was stiffer than the cap: its wrench was scaled
  bool bounded = false;         ///< injected damping exceeded its bound and was cut
  double scale = 1.0;  ///< part of the contact's wrench that is within the caps; see StiffnessScale
  double energy_j = 0.0;  ///< translation: what the hand has put in, net, since this contact began;
                          ///< see passivity.hpp
  double energy_rotation_j = 0.0;
  bool growing = false;  ///< force grew by itself: the command fades to zero and stays there
  double injected_n =
      0.0;  ///< size of the force that injected damping adds to the law's, or takes from it
};

/// Since construction, for diagnostics.
struct CouplingCounters {
  std::uint64_t samples = 0;
  std::uint64_t faults = 0;    ///< bad periods and bad inputs
  std::uint64_t repeated = 0;  ///< samples answered with the last good input once more
  std::uint64_t clamped = 0, capped = 0;
  std::uint64_t bounded = 0;  ///< samples in which injected damping was cut to what it may add
  std::uint64_t pose_jumps = 0;
  std::uint64_t not_finite =
      0;  ///< commands that no longer were numbers; the law was started again
  double lowest_energy_j = 0.0;  ///< of any single account of translation
  double lowest_energy_rotation_j = 0.0;
  Swing swing;           ///< the largest
  bool growing = false;  ///< force grew by itself, and the command has gone to zero for good
  double most_force_n = 0.0, most_torque_nm = 0.0;      ///< that was commanded
  double longest_path_m = 0.0, longest_turn_rad = 0.0;  ///< of one sample to the next, under force
};

/// One device's coupling. Steps are real-time safe: no allocation, no lock, no throw.
class RunningCoupling {
 public:
  /// Throws std::invalid_argument with the first refusal of `validate`, or for a ramp or speed
  /// limit that is none.
  RunningCoupling(const CouplingSpec& spec, const CouplingLimits& limits, double sample_time_s,
                  double ramp_s = kDefaultRampS, const ToolSpeedLimits& speeds = {});

  /// `dt_s` as measured between samples; out of [T/5, 5T] or not finite: the nominal period is used
  /// and counted. A gap of more than 10 T starts again at the force given last and fades the new
  /// input in. A non-finite input is replaced by the last good one and counted. Without contact
  /// nothing is added to the law's force, and where the law gives nothing the command is zero.
  CouplingOutput step(const CouplingInput& input, double dt_s) noexcept;
  /// Starts again at rest, giving `start`, as far as the limits allow, without a jump and fading
  /// from it to the contact; with `start` zero as InputPolicy::restart says. Velocity and energy
  /// begin again too. For a new session, a clutch, a jump that is meant.
  void reset(const Wrench& start) noexcept;

  /// Other parameters while running, also in contact, without a jump: cut-off and damping ratio at
  /// once (the filter's state cannot grow by it), the gain at kGainSlewPerS, the spring-damper's c
  /// and r and the caps over kDefaultRampS, injected damping over `ramp_behind_filter_s`, the
  /// velocity estimate at once. Another kind starts at the force that the old law gave and fades to
  /// its own. False, and nothing changed, where `validate` refuses. Between two steps of the loop:
  /// allocates only to word what validate finds.
  bool redesign(const CouplingSpec& spec);

  CouplingKind kind() const noexcept;
  double gain() const
      noexcept;  ///< of the shaping filter, on its way to the one that was set; 1 of the others
  const CouplingCounters& counters() const noexcept { return counters_; }
  const EnergyAccounts& energy() const noexcept { return passivity_.energy(); }
  const Twist& velocity() const noexcept { return motion_.velocity(); }  ///< v^ of the tool, W axes

 private:
  using Law =
      std::variant<DirectCoupling, ShapingFilter, SpringDamper>;  ///< in the order of CouplingKind
  static Law law_of(const CouplingSpec& spec, double sample_time_s) noexcept;
  void start_law_at(const Wrench& start) noexcept;
  double newly_supplied(const CouplingInput& input, double dt_s) noexcept;
  Wrench run_law(const CouplingInput& input, const PolicedSample& sample,
                 CouplingOutput& out) noexcept;
  void add_damping(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept;
  void finish(Wrench& sum, const Wrench& law, CouplingOutput& out) noexcept;
  void count_path() noexcept;
  void give_up(double dt_s, Wrench& sum, CouplingOutput& out) noexcept;
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
  double left_ = 1.0;      ///< of the command, once force has grown by itself
  CouplingInput contact_;  ///< the last usable one, scaled
  Wrench given_;           ///< by the law
  bool in_contact_ = false;
  double displayed_ = 1.0;            ///< of a force in W, by scale and gain
  std::optional<double> supplied_j_;  ///< as last set
  CouplingCounters counters_;

  static constexpr double kGiveUpS = 0.05;
};

}  // namespace voxtouch::coupling
