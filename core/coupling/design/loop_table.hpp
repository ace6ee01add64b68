#pragma once
/// Frequency responses of all cases, tabulated once, so that thousands of couplings can be compared
/// in tens of milliseconds. Interpolated, accurate to about one percent. The table proposes;
/// `critical_stiffness` certifies.
#include <functional>
#include <span>
#include <vector>

#include "core/coupling/design/design_cases.hpp"
#include "core/coupling/design/loop_response.hpp"

namespace voxtouch::coupling::design {

/// Limit of a stiffness: the loop becomes unstable; or any of its oscillations falls below
/// `least_damping_ratio` of the case (cases without a minimum are skipped).
enum class LoopLimit { kStable, kDamped };

class LoopTable {
 public:
  /// `velocities`: the estimates that injected damping may act on.
  LoopTable(const std::vector<DesignCase>& cases, std::span<const VelocityEstimate> velocities,
            LoopLimit limit = LoopLimit::kStable);

  /// Sets the law of the following calls: effort per unit of position, at a point of a loop with
  /// period [s].
  using LoopLaw = std::function<Complex(const DecayingPhasor& at, double period_s)>;
  void use(const LoopLaw& law);

  /// Factor on the law at which the worst case reaches the limit (for a law of unit stiffness: K
  /// k), with injected damping B on the velocity of that index. Infinity: no crossing.
  /// If a case lies below `enough`, the search stops and returns some smaller number; the last
  /// failing case is checked first. B must keep the inner loop stable. `damping_force_ratio`: B
  /// adds no more than that ratio of the law's force, and the remaining parts of B
  /// (`residual_damping`), times `large_swing`, are checked too; 0: no bound.
  double critical(std::size_t velocity, double injected_damping, double enough = 0.0,
                  double damping_force_ratio = 0.0, double large_swing = 1.0);

 private:
  struct Response {
    std::vector<double> re, im;
  };
  struct Case {
    std::size_t timing;
    Response plant, loop;
    std::vector<Response>
        damped;  ///< plant times unit injected damping, for each velocity estimate
  };
  /// Bound of a damper. A crossing counts only if at most `up_to` of the damper remains, and over
  /// `large_swing` it must be below `lowest`.
  struct Bound {
    double whole, fraction, up_to, large_swing, lowest;
  };
  static void add(Response& to, const Complex& value);
  static double critical(const Case& one, std::size_t velocity, double injected_damping,
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
  std::size_t first_ = 0;  ///< the last failing case
};

}  // namespace voxtouch::coupling::design
