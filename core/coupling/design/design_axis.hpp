#pragma once
/// One kind of motion, translation or rotation, as a problem to be designed for; and what certifies
/// an answer.
#include <limits>
#include <vector>

#include "core/coupling/design/design_cases.hpp"
#include "core/coupling/design/designer.hpp"

namespace voxtouch::coupling::design {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Room for rounding where a bound is met exactly.
inline constexpr double kRounding = 1.0 + 1e-9;

/// The design of axis 0, translation, or 1, rotation.
inline const AxisDesign& axis_of(const Design& design, std::size_t axis) noexcept {
  return axis == 0 ? design.translation : design.rotation;
}

/// Of the margin, what is kept in a swing so large that the bound on injected damping acts.
inline constexpr double kLargeSwing = 0.75;

struct AxisProblem {
  const AxisUnits* units = &kTranslationUnits;
  AxisModel model;
  LoopTiming timing;
  HandRange hand;
  ContactRange contact;
  std::vector<DesignCase> cases;
  double margin = 2.0;
  double large_swing = kLargeSwing;  ///< of `margin`, what is kept also in a swing so large that
                                     ///< the bound on injected damping acts; at least 1 over it
  double requested = 0.0;            ///< min(contact's total, the device's limit)
  double target = 0.0;  ///< K k at which the goal counts as met; below `requested` where one gain
                        ///< has to serve two axes
  double useful = 0.0;  ///< below it, and below the target, the design is called infeasible
  /// Of the device's damping, what a spring-damper's law may count on here. One law acts along a
  /// wrench [n; arm n], so force and torque draw on both dampings at once: beta (1/b + arm^2/br) <=
  /// 1 for a law that needs beta.
  double series_ratio = 1.0;
  double damping_force_ratio =
      0.0;                   ///< of the law's force, that injected damping may add: stable also
                             ///< with what is left of it (`residual_damping`); 0: not bounded
  double noise_limit = 0.0;  ///< noise that the injected damping may make, as an effort
};

/// Translation, and rotation where the device gives torque.
///
/// Two certificates of one axis each are enough for six degrees of freedom, as far as rule P goes.
/// Let the contact's wrench be the gradient of one energy whose stiffness K6 is symmetric, positive
/// semidefinite, and K6 <= D = diag(kt I, kr I) in the order of symmetric matrices; let the device
/// dissipate at least b |v|^2 + br |omega|^2. In the coordinates y = D^(1/2) x the stiffness is at
/// most the identity, so the wrench changes by no more than |y(t) - y(t - A)| over a delay A, and
/// the argument that proves the rule for one axis bounds the energy that delay, hold and filter can
/// create by
///     lag * integral |y'|^2 dt = lag * integral (kt |v|^2 + kr |omega|^2) dt,
/// with the rule's lag, the same for both since one filter serves both. The device covers it if lag
/// kt <= b and lag kr <= br: rule P for each axis alone. Hence also one w0, d and gain: a wrench
/// whose force and torque were filtered or scaled differently would be no gradient. K6 <= D is what
/// the spec's two caps enforce at run time; without them only K6 <= 2 diag(|Ktt| I, |Krr| I) holds,
/// and `coupled_stiffness` says so. Injected damping is dissipation, and may differ.
///
/// Rule H looks at each axis by itself as well, and there it is an approximation: a plant that
/// moves along and about an axis at once is not among its cases.
std::vector<AxisProblem> axis_problems(const DesignProblem& request);

/// Contact's arm [m^2]: rotational over translational stiffness. What one scalar law does to a
/// torque, in terms of a force.
double arm_squared(const DesignProblem& request);

/// The law that `spec` gives to the problem's axis, of unit gain, with its injected damping.
LoopController controller_of(const CouplingSpec& spec, const AxisProblem& problem,
                             double arm_squared_m2);

/// Speed that steps of the encoder make of the velocity estimate, at most [m/s, rad/s].
double step_speed(const AxisProblem& problem, const VelocityEstimate& velocity);

/// Largest error of the velocity estimate that positions off by up to q / 2 either way may make, in
/// q / T: 1 - exp(-w_v T), which is also what a single step of the encoder makes; with a window
/// `window_step_ratio`, of which a single step makes less.
double step_ratio(double velocity_filter_rad_per_s, int velocity_window, double period_s);
/// Largest injected damping on this velocity: half of what the inner loop bears in the worst case,
/// and no more noise than allowed.
double damping_limit(const AxisProblem& problem, const VelocityEstimate& velocity);
/// The least critical damping over the cases.
double critical_damping(const AxisProblem& problem, const VelocityEstimate& velocity);

/// Where the worst case becomes unstable, exactly.
struct WorstCase {
  double stiffness = 0.0;  ///< K k
  std::size_t index = 0;   ///< of the problem's cases
};
/// Stops at the first case below `enough`: then the answer is an upper bound. For filter and
/// direct.
WorstCase critical_case(const AxisProblem& problem, const LoopController& law, double enough = 0.0);
/// Factor on a spring-damper's whole law (contact, c and r alike, so on its effort) at which the
/// worst case becomes unstable.
WorstCase critical_scale(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness);

/// K k that is stable with every passive hand; for the spring-damper the factor on its law.
/// Injected damping never helps here: late, it may push for part of a period, so its fraction of
/// the device's damping is taken off.
double passive_limit(const AxisProblem& problem, const LoopController& law);

/// What the design may promise: the limit by rule P for a hand of which only passivity is known, by
/// rule H otherwise, over the margin.
double certified_stiffness(const AxisProblem& problem, const LoopController& law,
                           double enough = 0.0);
/// The same for who knows `critical_case`.
double certified_stiffness(const AxisProblem& problem, const LoopController& law,
                           const WorstCase& worst);

/// Largest modulus over the cases at that contact stiffness; `law` has unit gain. Infinity where it
/// could not be computed.
double worst_radius(const AxisProblem& problem, const LoopController& law,
                    double contact_stiffness);

/// Whole samples of delay, the effort's lag counted in, rounded up.
int whole_delay(const LoopTiming& timing, double effort_lag_s);

}  // namespace voxtouch::coupling::design
