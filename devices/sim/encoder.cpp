#include "devices/sim/encoder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace voxtouch::sim {

Vec3 quantise(const Vec3& position, double resolution) noexcept {
  if (!(resolution > 0.0))
    return position;
  // The sum replaces -0 by 0, so that equal positions have equal bits.
  return position.unaryExpr(
      [resolution](double x) { return std::round(x / resolution) * resolution + 0.0; });
}

Quat quantise(const Quat& orientation, double resolution_rad) noexcept {
  if (!(resolution_rad > 0.0))
    return orientation;
  // The largest component is found from the other three: it is at least a half, so its own rounding
  // error stays small.
  Eigen::Index largest = 0;
  const Eigen::Vector4d exact = orientation.coeffs();
  exact.cwiseAbs().maxCoeff(&largest);
  const double step = 0.5 * resolution_rad;
  Eigen::Vector4d rounded =
      exact.unaryExpr([step](double x) { return std::round(x / step) * step + 0.0; });
  rounded[largest] = 0.0;
  const double rest = 1.0 - rounded.squaredNorm();
  rounded[largest] = std::copysign(std::sqrt(std::max(rest, 0.0)), exact[largest]);
  return Quat(rounded).normalized();
}

Encoder::Encoder(double position_resolution_m, double orientation_resolution_rad, double filter_hz,
                 double period_s) noexcept
    : position_resolution_m_(position_resolution_m),
      orientation_resolution_rad_(orientation_resolution_rad),
      per_period_(1.0 / period_s) {
  const double angle_per_sample = 2.0 * std::numbers::pi * filter_hz * period_s;
  follow_ =
      angle_per_sample / (1.0 + angle_per_sample);  // backward Euler: its lag at low frequency is 1
                                                    // / (2 pi filter_hz) exactly
}

void Encoder::sample(const Pose& truth) noexcept {
  const Pose before = pose_;
  pose_ = {quantise(truth.position, position_resolution_m_),
           quantise(truth.orientation, orientation_resolution_rad_)};
  if (std::exchange(first_, false))
    return;
  const Vec3 linear = (pose_.position - before.position) * per_period_;
  const Quat rotation = pose_.orientation * before.orientation.conjugate();
  const Vec3 angular = (rotation.w() < 0.0 ? -2.0 : 2.0) * per_period_ *
                       rotation.vec();  // 2 sin(a / 2): a step is small
  twist_.linear += follow_ * (linear - twist_.linear);
  twist_.angular += follow_ * (angular - twist_.angular);
}

}  // namespace voxtouch::sim
