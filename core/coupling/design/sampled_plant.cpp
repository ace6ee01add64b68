#include "core/coupling/design/sampled_plant.hpp"

#include <cmath>

namespace voxtouch::coupling::design {
namespace {

using Eigen::Matrix4d;

/// A delay this close to whole periods [periods] is rounded, which saves a state.
constexpr double kWholeDelay = 1e-9;

/// A shorter lag [periods] is ignored: the doublings of its exponential would not terminate.
constexpr double kNoLag = 1e-9;

/// exp(a) - 1, by a Taylor series of a small fraction of `a` and doubling:
///     e(2 a) = 2 e(a) + e(a)^2
/// Zero columns stay exactly zero.
Matrix4d exp_less_one(const Matrix4d& a) {
  constexpr int kTerms = 14;  // 0.5^15 / 15! is below rounding
  const double size = a.cwiseAbs().colwise().sum().maxCoeff();
  const int doublings = size > 0.5 ? static_cast<int>(std::ceil(std::log2(size / 0.5))) : 0;
  const Matrix4d fraction = std::ldexp(1.0, -doublings) * a;
  Matrix4d sum = Matrix4d::Identity();
  for (int i = kTerms; i >= 2; --i)
    sum = Matrix4d::Identity() + fraction * sum / i;
  Matrix4d e = fraction * sum;
  for (int i = 0; i < doublings; ++i)
    e = 2.0 * e + e * e;
  return e;
}

}  // namespace

SampledPlant sample_plant(double mass, double damping, double stiffness, double period_s,
                          double delay_s, double effort_lag_s) {
  SampledPlant out;
  out.effort_unit = period_s * period_s / mass;
  out.order = effort_lag_s > kNoLag * period_s ? 3 : 2;

  // States x, T v, f and the held command, per period.
  Matrix4d rate = Matrix4d::Zero();
  rate(0, 1) = 1.0;
  rate(1, 0) = -stiffness * out.effort_unit;
  rate(1, 1) = -damping * period_s / mass;
  if (out.order == 3) {
    const double lag_rate = period_s / effort_lag_s;
    rate(1, 2) = 1.0;
    rate(2, 2) = -lag_rate;
    rate(2, 3) = lag_rate;
  } else {
    rate(1, 3) = 1.0;
  }

  const double delay = delay_s / period_s;
  out.whole_delay = static_cast<int>(std::floor(delay + kWholeDelay));
  // Fraction of the period in which the previous command still acts.
  double late = delay - out.whole_delay;
  if (late < kWholeDelay)
    late = 0.0;
  const Matrix4d last = exp_less_one((1.0 - late) * rate);
  out.step_less_one = last.topLeftCorner<3, 3>();
  out.newer = last.topRightCorner<3, 1>();
  if (late > 0.0) {
    const Matrix4d first = exp_less_one(late * rate);
    const Eigen::Vector3d first_effect = first.topRightCorner<3, 1>();
    out.older = first_effect + last.topLeftCorner<3, 3>() * first_effect;
    out.step_less_one = last.topLeftCorner<3, 3>() + first.topLeftCorner<3, 3>() +
                        last.topLeftCorner<3, 3>() * first.topLeftCorner<3, 3>();
  }
  return out;
}

}  // namespace voxtouch::coupling::design
