#pragma once
/// Device and hand over one period, exactly: the effect of a held command on the position at the
/// next sample.
///
///     m x'' + b x' + k_h x = f,   f + lag f' = command
///
/// The command is held over a period and delayed by `delay` (any fraction of T). Time is counted in
/// periods and effort in m/T^2, so that the numbers are near 1 for a device of any size.
#include <Eigen/Core>

#include "core/coupling/design/sampled_loop.hpp"

namespace voxtouch::coupling::design {

/// States X = [x, T v, T^2/m f]; a command u [N or Nm] enters as (T^2/m) u. Without a lag f is not
/// a state: order 2, last row and column zero.
struct SampledPlant {
  /// X[n+1] - X[n] = step_less_one X[n] + newer ... + older ...
  Eigen::Matrix3d step_less_one = Eigen::Matrix3d::Zero();
  /// ... the command of `whole_delay` samples ago.
  Eigen::Vector3d newer = Eigen::Vector3d::Zero();
  /// ... the command one sample earlier; zero for a whole delay.
  Eigen::Vector3d older = Eigen::Vector3d::Zero();
  int whole_delay = 0;       ///< whole periods of the delay
  int order = 2;             ///< 2, or 3 with a lag
  double effort_unit = 1.0;  ///< T^2/m

  bool splits_period() const noexcept { return !older.isZero(0.0); }
};

/// Computes the sampled plant. All values finite; mass and period > 0, the others >= 0. The step is
/// stored minus the identity, by a Taylor series and doubling of exp(A) - 1. Near z = 1, where a
/// slow loop has its dynamics, the difference z - exp(A) thus keeps all digits.
SampledPlant sample_plant(double mass, double damping, double stiffness, double period_s,
                          double delay_s, double effort_lag_s);
/// Device and hand together.
inline SampledPlant sample_plant(const LoopPlant& p) {
  return sample_plant(p.mass + p.hand_mass, p.damping + p.hand_damping, p.hand_stiffness,
                      p.period_s, p.delay_s, p.effort_lag_s);
}

}  // namespace voxtouch::coupling::design
