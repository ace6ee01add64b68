#pragma once
/// The measured pose of the device: encoder counts and derived values.
#include "devices/phantom/phantom_arm.hpp"
#include "devices/sim/encoder.hpp"

namespace voxtouch::hd_sim {

/// One reading, in SI units and with the signs of the joints.
struct Reading {
  Vec3 joints = Vec3::Zero();  ///< from the counts [rad]
  Pose pose;                   ///< of the stylus in D, from those angles
  Twist twist;                 ///< difference from the previous reading, low-passed
};

/// Six encoders that count from their zero position. Real-time safe.
class Sensors {
 public:
  /// `resolution_m`: step of each joint at the end of its link.
  Sensors(const phantom::PhantomGeometry& geometry, double resolution_m,
          double gimbal_resolution_rad, double velocity_filter_hz) noexcept;

  /// Sets the counts of the three joints to zero at these true angles. The velocity restarts.
  void zero_at(const Vec3& joints) noexcept;
  /// Sets the sample period. The velocity restarts.
  void set_period(double period_s) noexcept;
  /// The reading at these true angles [rad] and this orientation of the stylus in D. Valid until
  /// the next call.
  const Reading& sample(const Vec3& joints, const Quat& orientation) noexcept;
  const Reading& reading() const noexcept { return reading_; }  ///< the last one
  const Vec3& step_rad() const noexcept { return step_; }       ///< of the three joints' encoders

 private:
  phantom::PhantomGeometry geometry_;
  Vec3 step_;
  double gimbal_step_, filter_hz_, period_s_ = 1e-3;
  Vec3 zero_ = Vec3::Zero();
  sim::Encoder differences_;
  Reading reading_;
};

}  // namespace voxtouch::hd_sim
