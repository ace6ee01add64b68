#pragma once
/// The design problem of one kind of motion, translation or rotation, and the certificates of its
/// solution.
#include <limits>
#include <vector>

#include "core/coupling/design/design_cases.hpp"
#include "core/coupling/design/designer.hpp"

namespace voxtouch::coupling::design {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Tolerance for rounding if a bound is met exactly.
inline constexpr double kRounding = 1.0 + 1e-9;

/// The design of axis 0 (translation) or 1 (rotation).
inline const AxisDesign& axis_of(const Design& design, std::size_t axis) noexcept {
  return axis == 0 ? design.translation : design.rotation;
}

/// Fraction of the margin that is kept in an oscillation large enough to reach the bound of
/// injected damping.
inline constexpr double kLargeSwing = 0.75;

struct AxisProblem {
  std::size_t axis = 0;  ///< 0: translation, 1: rotation
  AxisModel model;
  LoopTiming timing;
  HandRange hand;
  ContactRange contact;
  std::vector<DesignCase> cases;
  double margin = 2.0;
  /// Fraction of `margin` kept when injected damping reaches its bound; at least 1 / margin.
  double large_swing = kLargeSwing;
  double requested = 0.0;  ///< min(contact's total, the device's limit)
  /// K k at which the goal counts as met; below `requested` if one gain serves two axes.
  double target = 0.0;
  double useful = 0.0;  ///< below it, and below the target, the design is infeasible
  /// Fraction of the device's damping available to a spring-damper on this axis. One law acts along
  /// a wrench [n; arm n], so force and torque use both dampings at once. A law that needs beta
  /// requires
  ///     beta (1/b + arm^2/br) <= 1
  double series_ratio = 1.0;
  /// Ratio of the law's force that injected damping may add. The loop must also be stable with the
  /// remaining damping (`residual_damping`); 0: no bound.
  double damping_force_ratio = 0.0;
  double noise_limit = 0.0;  ///< largest noise of the injected damping, as an effort
  /// Largest effort that one encoder step may make, contact and damping together; infinity: any.
  double step_limit = std::numeric_limits<double>::infinity();
};

/// Returns the problem of translation and, if the device gives torque, of rotation.
///
/// Under rule P, two certificates of one axis each are sufficient for six degrees of freedom. Let
/// the contact's wrench be the gradient of one energy with a symmetric, positive semidefinite
/// stiffness K6. In the order of symmetric matrices let K6 <= D = diag(kt I, kr I). Let the device
/// dissipate at least b |v|^2 + br |omega|^2. In the coordinates y = D^(1/2) x the stiffness is at
/// most the identity. The wrench thus changes by at most |y(t) - y(t - A)| over a delay A. The
/// proof of the rule for one axis then bounds the energy that delay, hold and filter can create by
///
///     lag * integral |y'|^2 dt = lag * integral (kt |v|^2 + kr |omega|^2) dt
///
/// with the lag of the rule, which is common because one filter serves both. The device dissipates
/// it if lag kt <= b and lag kr <= br: rule P for each axis alone. This requires one common w0, d
/// and gain: a wrench whose force and torque are filtered or scaled differently is not a gradient.
/// The two caps of the specification enforce K6 <= D at run time. Without them only K6 <= 2
/// diag(|Ktt| I, |Krr| I) holds, which `coupled_stiffness` accounts for. Injected damping is
/// dissipation and may differ between the axes.
///
/// The limit over the cases (`critical_case`) also considers each axis alone, which is an
/// approximation: a plant that moves along and about an axis at once is not among its cases.
std::vector<AxisProblem> axis_problems(const DesignProblem& request);

/// Squared arm of the contact [m^2]: rotational over translational stiffness. It relates the effect
/// of one scalar law on a torque to that on a force.
double arm_squared(const DesignProblem& request);

/// The law of `spec` for the problem's axis, with unit gain and its injected damping.
LoopController controller_of(const CouplingSpec& spec, const AxisProblem& problem,
                             double arm_squared_m2);

/// Largest speed error of the velocity estimate from encoder steps [m/s, rad/s].
double step_speed(const AxisProblem& problem, const VelocityEstimate& velocity);

/// Largest error of the velocity estimate, in q / T, for position errors of up to q / 2.
double step_ratio(double velocity_filter_rad_per_s, int velocity_window, double period_s);
/// Largest injected damping on this velocity: half of the critical damping of the inner loop in the
/// worst case, and within the noise limit.
double damping_limit(const AxisProblem& problem, const VelocityEstimate& velocity);
/// The least critical damping over the cases.
double critical_damping(const AxisProblem& problem, const VelocityEstimate& velocity);

/// K k up to which one encoder step makes at most the `step_limit`:
///
///     K k q + B (velocity error of a step) <= kReleasedStepN + kStepsOfFriction F_c
///
/// A released device that has little friction bounces between the walls of a slot without end, by
/// up to twice that effort. Infinity for a gripped device and for rotation.
double quiet_stiffness(const AxisProblem& problem, const LoopController& law);
/// Whether the `step_limit` may limit the design.
bool may_bounce(const AxisProblem& problem);

/// The exact stability limit of the worst case.
struct WorstCase {
  double stiffness = 0.0;  ///< K k
  std::size_t index = 0;   ///< index in the problem's cases
};
/// Stops at the first case below `enough`; the result is then an upper bound. For filter and direct
/// coupling.
WorstCase critical_case(const AxisProblem& problem, const LoopController& law, double enough = 0.0);
/// Factor on the whole law of a spring-damper (contact, c and r, hence its effort) at which the
/// worst case becomes unstable.
WorstCase critical_scale(const AxisProblem& problem, const LoopController& law,
                         double contact_stiffness);

/// K k that is stable with every passive hand; for the spring-damper the factor on its law.
/// Injected damping acts late and may drive the motion for part of a period, so it is subtracted
/// from the device's damping.
double passive_limit(const AxisProblem& problem, const LoopController& law);

/// The stiffness that the design may certify: the limit over the margin, and at most the
/// `quiet_stiffness`. The limit is that of rule P for a hand only known to be passive, otherwise
/// that over the cases.
double certified_stiffness(const AxisProblem& problem, const LoopController& law,
                           double enough = 0.0);
/// The same for an already computed `critical_case`.
double certified_stiffness(const AxisProblem& problem, const LoopController& law,
                           const WorstCase& worst);

/// Largest spectral radius over the cases at that contact stiffness; `law` has unit gain. Infinity
/// if it could not be computed.
double worst_radius(const AxisProblem& problem, const LoopController& law,
                    double contact_stiffness);

/// Delay in whole samples, including the lag of the effort, rounded up.
int whole_delay(const LoopTiming& timing, double effort_lag_s);

}  // namespace voxtouch::coupling::design
