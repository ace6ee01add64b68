#pragma once
/// Frequency responses of all cases, tabulated once, so that thousands of couplings can be compared
/// in some tens of milliseconds. Interpolated: good to about a percent. It proposes;
/// `critical_stiffness` certifies.
#include <functional>
#include <span>
#include <vector>

#include "core/coupling/design/design_cases.hpp"
#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::coupling::design {

/// What a stiffness may not pass: the loop grows; or a swing of it, also one that is not the
/// slowest, has less than the case's `least_damping_ratio` (cases without one are left out).
enum class LoopLimit { kStable, kDamped };

class LoopTable {
 public:
  /// `velocities`: the estimates that injected damping may act on.
  LoopTable(const std::vector<DesignCase>& cases, std::span<const VelocityEstimate> velocities,
            LoopLimit limit = LoopLimit::kStable);

  /// The law for the following questions: effort for a unit of position, at a point of a loop with
  /// period [s].
  using LoopLaw = std::function<Complex(const DecayingPhasor& at, double period_s)>;
  void use(const LoopLaw& law);

  /// Factor on the law at which the worst case passes the limit (for a law of unit stiffness: K k),
  /// with injected damping B on the velocity of that index. Where a case lies below `enough`, the
  /// rest is not looked at, and the answer is some number below; the case that fell short last is
  /// looked at first. B has to keep the inner loop stable. `damping_force_ratio`: B adds no more
  /// than that of the law's force, and the same is asked with the parts of B that may be left of it
  /// (`residual_damping`), times `large_swing`; 0: not bounded. Infinity: no crossing.
  double critical(std::size_t velocity, double injected_damping, double enough = 0.0,
                  double damping_force_ratio = 0.0, double large_swing = 1.0);

 private:
  struct Response {
    std::vector<double> re, im;
  };
  /// Between the points before `end` and `end` the loop may cross the real axis while B is between
  /// `least` and `most`.
  struct Crossing {
    double least, most;
    std::size_t end;
  };
  struct Case {
    std::size_t timing;
    Response plant, loop;
    std::vector<Response>
        damped;  ///< plant times a unit of injected damping, for each velocity estimate
    std::vector<std::vector<Crossing>>
        crossings;  ///< of each velocity estimate, in order; empty: not yet looked for
  };
  /// Of a damper of which no more than `up_to` has to be left for a crossing to count; and over
  /// `large_swing` it has to be below `lowest`.
  struct Bound {
    double whole, fraction, up_to, large_swing, lowest;
  };
  static void add(Response& to, const Complex& value);
  static std::vector<Crossing> crossings_of(const Response& loop, const Response& unit);
  static double critical(Case& one, std::size_t velocity, double injected_damping,
                         const Bound* bound);

  struct Timing {
    double period_s, damping_ratio;
    std::vector<DecayingPhasor> grid;
    std::vector<std::vector<Complex>> velocities;  ///< V on the grid, for each estimate
  };
  static Timing timing_of(double period_s, double damping_ratio,
                          std::span<const VelocityEstimate> velocities);
  std::vector<Timing> timings_;
  std::vector<Case> cases_;
  std::size_t first_ = 0;  ///< case that fell short last
};

}  // namespace voxtouch::coupling::design
