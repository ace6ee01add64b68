#pragma once
/// The measured pose of a simulated device: quantised positions, and a velocity made from
/// them.
#include "core/types/geometry.hpp"

namespace voxtouch::sim {

/// The nearest multiple of `resolution` on each axis (halves away from zero); 0: `position` itself.
Vec3 quantise(const Vec3& position, double resolution) noexcept;

/// The orientation near `orientation` whose three smaller quaternion components are multiples of
/// resolution / 2 [rad]: the angle to it is at most about 0.87 of the resolution for small angles,
/// and below twice the resolution for any. The sign is that of `orientation`. 0: `orientation`
/// itself.
Quat quantise(const Quat& orientation, double resolution_rad) noexcept;

/// Backward difference of the quantised poses through a first-order low-pass. At low frequency the
/// twist lags the true one by half a period (difference) and 1 / (2 pi filter_hz) (filter).
/// Real-time safe.
class Encoder {
 public:
  /// Steps [m, rad], 0 for none; cut-off of the velocity's low-pass [Hz]; the time between samples
  /// [s].
  Encoder(double position_resolution_m, double orientation_resolution_rad, double filter_hz,
          double period_s) noexcept;

  /// Takes the true pose once a period. The first call gives zero twist.
  void sample(const Pose& truth) noexcept;
  const Pose& pose() const noexcept { return pose_; }
  const Twist& twist() const noexcept { return twist_; }

 private:
  double position_resolution_m_, orientation_resolution_rad_, per_period_, follow_;
  bool first_ = true;
  Pose pose_;
  Twist twist_;
};

}  // namespace voxtouch::sim
