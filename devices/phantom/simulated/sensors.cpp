#include "devices/phantom/simulated/sensors.hpp"

#include <cmath>

namespace voxtouch::hd_sim {

Sensors::Sensors(const phantom::PhantomGeometry& g, double resolution_m,
                 double gimbal_resolution_rad, double velocity_filter_hz) noexcept
    : geometry_(g),
      step_(resolution_m / g.thigh_m, resolution_m / g.thigh_m, resolution_m / g.shin_m),
      gimbal_step_(gimbal_resolution_rad),
      filter_hz_(velocity_filter_hz),
      differences_(0.0, 0.0, velocity_filter_hz, period_s_) {}

void Sensors::zero_at(const Vec3& joints) noexcept {
  zero_ = joints;
  set_period(period_s_);
}

void Sensors::set_period(double period_s) noexcept {
  period_s_ = period_s;
  differences_ = sim::Encoder(0.0, 0.0, filter_hz_, period_s);
}

const Reading& Sensors::sample(const Vec3& joints, const Quat& orientation) noexcept {
  // The gimbal angles are those of the true arm. If the arm is not calibrated, the orientation has
  // the same error.
  const Vec3 true_gimbal = phantom::gimbal_angles(joints, orientation);
  Vec3 gimbal;
  for (int i = 0; i < 3; ++i) {
    reading_.joints[i] =
        static_cast<double>(std::lround((joints[i] - zero_[i]) / step_[i])) * step_[i];
    gimbal[i] = static_cast<double>(std::lround(true_gimbal[i] / gimbal_step_)) * gimbal_step_;
  }
  reading_.pose = {phantom::phantom_tip(geometry_, reading_.joints),
                   phantom::stylus_orientation(reading_.joints, gimbal)};
  differences_.sample(reading_.pose);
  reading_.twist = differences_.twist();
  return reading_;
}

}  // namespace voxtouch::hd_sim
