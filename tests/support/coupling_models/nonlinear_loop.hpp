#pragma once
/// A time-domain simulation of the loop with effects outside the linear model: a unilateral
/// contact, quantised position, jitter, lost samples, saturation, dry friction. One axis. It uses
/// the ring's filter (core/coupling/pt2.hpp).
///
/// Positive is into the wall, with its surface at 0, which is also the rest position of the hand's
/// spring. The plant is solved in closed form (exact_plant.hpp), so the result does not depend on a
/// step length.
#include <cstdint>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling_models {

/// Force over depth p, k the contact's stiffness. All are monotone with slopes up to k.
enum class WallLaw : std::uint8_t {
  kBilateral,   ///< k p on both sides: the linear model's
  kUnilateral,  ///< k max(0, p)
  kSoftening,   ///< unilateral; k to the knee, 0.3 k beyond
  kHardening,   ///< unilateral; 0.3 k to the knee, k beyond
};

/// Changes during a run; zero: no change.
struct LoopDisturbance {
  double at_s = 0.0;              ///< when they begin
  double stiffness_factor = 1.0;  ///< the contact's stiffness becomes this many times itself,
  double stiffness_ramp_s = 0.0;  ///< linearly within this time
  double more_delay_s = 0.0;      ///< added to the delay from then on; may be negative
  double silence_s =
      0.0;  ///< all samples of this time are lost, whatever `most_consecutive_losses`
};

/// Parameters of one run; zero: none.
struct NonlinearLoop {
  coupling::design::LoopPlant plant;
  coupling::design::LoopController controller;
  double contact_stiffness = 0.0;  ///< steepest slope of the wall
  WallLaw wall = WallLaw::kUnilateral;
  double wall_knee = 1e-3;  ///< depth at which the softening and hardening walls change their slope
  double resolution = 0.0;
  double measurement_noise =
      0.0;  ///< added to the position before it is quantised, uniformly within +- this
  double coulomb_friction = 0.0;
  double max_effort =
      0.0;  ///< 0: no saturation. Clamps the filter's input to it / gain and the sum to it
  double jitter = 0.0;           ///< periods uniformly within (1 +- jitter) T
  bool measured_period = false;  ///< the controller uses the actual period (as the ring); false: T
  double delay_jitter_s =
      0.0;  ///< added to the delay, uniformly; an effort that newer ones have overtaken is dropped
  double loss =
      0.0;  ///< probability that a sample is lost; its input is repeated and the filter continues
  int most_consecutive_losses = 3;
  int fade_after_lost =
      0;  ///< more lost in a row than this: effort fades out within kFadeOutS; 0: never
  bool damping_only_in_contact =
      false;  ///< injected damping as the ring does it: in contact, never pulling,
  double damping_fraction =
      0.0;  ///< and adding at most this fraction of the law's effort, 0: without that bound,
  double damping_free = 0.0;             ///< and this
  double slow_velocity_rad_per_s = 0.0;  ///< within `velocity_band` of the controller's velocity it
                                         ///< acts on that of a filter with this cut-off
  double velocity_band = 0.0;
  double push = 0.0;  ///< constant effort of the hand into the wall
  double start_position = 0.0;
  double start_speed = 0.0;  ///< into the wall
  LoopDisturbance disturbance;
  double duration_s = 10.0;  ///< at least
  double longest_s = 0.0;  ///< at most, for runs that are not decided by then; 0: 16 x duration; =
                           ///< duration: exactly that
  std::uint64_t seed = 0;
};

inline constexpr double kFadeOutS = 0.02,
                        kFadeInS = 0.2;  ///< of `fade_after_lost`; in: when samples arrive again

enum class LoopOutcome : std::uint8_t {
  kRest,       ///< the last quarter's amplitude is at most `quiet`
  kDecaying,   ///< not at rest at the end, but every quarter is at least 10 % smaller than the one
               ///< before, without flattening
  kSustained,  ///< neither
  kRunaway,    ///< beyond kRunaway, or not finite
};
inline constexpr double kRunaway = 1e3;  ///< [m] or [rad]

/// Counts of the run, so that a test can check that the requested events occurred.
struct LoopStatistics {
  std::uint64_t samples = 0, lost = 0, longest_loss = 0, overtaken = 0, saturated = 0;
  double period_min = 0.0, period_max = 0.0, period_mean = 0.0;
  double delay_min = 0.0, delay_max = 0.0;
};

struct NonlinearVerdict {
  bool stable = false;  ///< the oscillation decays or stays below `quiet`: kRest or kDecaying
  LoopOutcome outcome = LoopOutcome::kSustained;
  double early_amplitude = 0.0,
         late_amplitude = 0.0;      ///< peak to peak, third and last quarter of the run
  double late_effort = 0.0;         ///< peak to peak of the commanded effort in the last quarter
  double energy_extracted_j = 0.0;  ///< largest energy that the coupling has given to the hand, net
  double work_j = 0.0;              ///< energy supplied to the hand by the end; negative: absorbed
  double quiet = 0.0;               ///< amplitude that counts as rest
  double end_position = 0.0;
  double deepest = 0.0;  ///< largest position of the run
  double simulated_s = 0.0;
  LoopStatistics statistics;
};

/// Equal loops and seeds give bit-identical results.
///
/// The verdict compares the peak-to-peak positions of the run's quarters. A run that is not at rest
/// but still decays is doubled, up to `longest_s`, and evaluated again, so slow decays are
/// distinguished from oscillations. It ends early if, at two consecutive lengths, its rate would
/// not give a decay of a tenth within a quarter of the longest run. `duration_s` should thus be
/// several times the slowest time constant; see `settling_time`.
///
/// Rest is the residual motion of a quantiser: q ||T_c||_1 peak to peak (the sum of the position's
/// step response to a measurement error, found by a linear simulation), but at most 30 q; at least
/// q, and 1e-4 of the run's largest quarter.
NonlinearVerdict simulate(const NonlinearLoop& loop);

/// Sum over the samples of |position| after one sample was measured 1 too large: ||T_c||_1 of the
/// bilateral loop with stiffness `contact_stiffness`. To 1 %, or over the first half million
/// samples for a slower decay. 1 without decay.
double quantiser_gain(const NonlinearLoop& loop, double contact_stiffness);

/// Contact stiffness from which on the loop is unstable, by doubling from `stable` and bisection to
/// `accuracy` (relative), for comparison with a certificate. Every other parameter is `loop`'s.
/// `stable` if the loop is already unstable there, `highest` if it is never unstable.
double simulated_limit(NonlinearLoop loop, double stable, double highest, double accuracy = 0.02);

/// Slowest time constant of the loop's parts alone [s]: free flight 2 M / B, the gripped device's,
/// filters. A margin close to 1 is slower.
double settling_time(const NonlinearLoop& loop);

}  // namespace voxtouch::coupling_models
