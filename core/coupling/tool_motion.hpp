#pragma once
/// How the tool has moved since the last sample, and how fast, out of poses alone.
#include <cstdint>

#include "core/types/geometry.hpp"

namespace voxtouch::coupling {

/// Faster than this, in W, no hand moves a tool: the pose has jumped. Multiply by the device's position scale.
struct ToolSpeedLimits {
  double linear_m_per_s = 10.0;
  double angular_rad_per_s = 100.0;
};

/// The way from one pose to the next.
struct ToolStep {
  bool known = false;         ///< false: first pose, bad pose, jump or gap; the ways are zero then
  Vec3 shift = Vec3::Zero();  ///< of the tool's origin [m], W axes
  Vec3 turn = Vec3::Zero();   ///< rotation vector [rad], the shorter way round, W axes
};

/// Differences and filtered velocity. Real-time safe.
///
///     v^[n] = a v^[n-1] + (1 - a) (x[n] - x[n-1]) / dt,   a = exp(-w_v dt),
///
/// a convex mean of difference quotients, so never larger than the largest of them. dt as measured, up to the gap; below the
/// input policy's band, or no number: the nominal period. (Above the band a law must not trust dt, since its state would grow
/// with it. Here a longer dt is the smaller velocity.) A sample without a usable pose leaves v^ as it is and its time counts
/// towards the next; after a gap, and after a jump, v^ begins again at zero.
class ToolMotion {
 public:
  /// `nominal_s`: the sample time [s]; `limits`: a pose that would need a faster tool is a jump.
  ToolMotion(double nominal_s, double velocity_filter_hz, const ToolSpeedLimits& limits) noexcept;

  /// The way to `tool` (T in W) and the velocity there, `dt_s` [s] after the last sample. Valid until the next call.
  const ToolStep& step(const Pose& tool, double dt_s) noexcept;
  /// Another cut-off of v^ [Hz], from the next sample on.
  void set_filter(double velocity_filter_hz) noexcept;
  /// The next pose is the first: no way leads to it, and v^ begins at zero.
  void forget() noexcept;
  const Twist& velocity() const noexcept { return velocity_; }  ///< v^, W axes
  std::uint64_t jumps() const noexcept { return jumps_; }

 private:
  void move_to(const Vec3& position, const Quat& orientation) noexcept;

  double nominal_s_, cutoff_rad_per_s_ = 0.0, elapsed_s_ = 0.0;
  ToolSpeedLimits limits_;
  bool anchored_ = false;
  Pose last_;
  ToolStep step_;
  Twist velocity_;
  std::uint64_t jumps_ = 0;
};

}  // namespace voxtouch::coupling
