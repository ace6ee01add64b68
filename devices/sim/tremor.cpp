#include "devices/sim/tremor.hpp"

#include <cmath>
#include <numbers>

namespace voxtouch::sim {

double near_normal(std::mt19937_64& random) noexcept {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i)
    sum += static_cast<double>(random() >> 11) * 0x1p-53;
  return sum;
}

Tremor::Tremor(double sigma_n, double bandwidth_hz, double period_s, std::uint64_t seed)
    : sigma_n_(sigma_n),
      random_(seed) {
  keep_ = 1.0 / (1.0 + 2.0 * std::numbers::pi * bandwidth_hz * period_s);
  // The standard deviation of the force is sigma_n for any bandwidth.
  gain_ = sigma_n * std::sqrt(1.0 - keep_ * keep_);
}

Vec3 Tremor::next() noexcept {
  if (sigma_n_ == 0.0)
    return Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    force_[axis] = keep_ * force_[axis] + gain_ * near_normal(random_);
  return force_;
}

}  // namespace voxtouch::sim
